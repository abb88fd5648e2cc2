// Success criterion, success rates with confidence intervals, and tables.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/studies/walking/course.h"

namespace kaz::walking {

// Returns whether a trial succeeded, which requires that the robot did not fall. A walk may miss its goal by
// 10 % of the distance, and its heading by 8 degrees. A turn may be off by 6 degrees. After getting up, the
// robot must stand at the end.
bool succeeded(const Trial& trial, const Outcome& outcome);

// Returns Markdown, a row for each trial that has outcomes.
std::string table(const studies::EpisodeFile& file, const std::vector<Trial>& all_trials,
                  const std::string& mcu);
// Returns errors of the behavior's position estimate at the end of a walk, mm and degrees. Also their root
// mean square in units of the estimated sigma, which is 1 if the sigmas are right. Empty without estimates.
std::string odometry_table(const studies::EpisodeFile& file, const std::vector<Trial>& all_trials,
                           const std::string& mcu);
std::string summary_json(const studies::EpisodeFile& file, const std::vector<Trial>& all_trials,
                         const std::string& mcu);
// Writes walking_paths.svg and .png to `folder`: trunk paths from above, with and without gyro. Writes
// nothing without outcomes.
Result<void> write_plots(const studies::EpisodeFile& file, const std::string& mcu,
                         const std::string& folder);

}  // namespace kaz::walking
