// Success criterion, success rates with confidence intervals, and tables.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/studies/walking/course.h"

namespace kaz::walking {

// No fall, and: of a walk, at most 10 % of the distance and 8 degrees of heading off; of a turn, at most 6
// degrees off. Standing: no fall. Getting up: it stands at the end.
bool succeeded(const Trial& trial, const Outcome& outcome);

// Markdown, a row for each trial that has outcomes.
std::string table(const studies::EpisodeFile& file, const std::vector<Trial>& all_trials,
                  const std::string& mcu);
// Errors of the behaviour's own position estimate at the end of a walk, mm and degrees, and root mean
// square of errors in units of the estimate's sigma (1: the sigmas are right).
std::string odometry_table(const studies::EpisodeFile& file, const std::vector<Trial>& all_trials,
                           const std::string& mcu);
std::string summary_json(const studies::EpisodeFile& file, const std::vector<Trial>& all_trials,
                         const std::string& mcu);
// walking_paths.svg and .png in `folder`: trunk paths from above, with and without gyro.
Result<void> write_plots(const studies::EpisodeFile& file, const std::string& mcu,
                         const std::string& folder);

}  // namespace kaz::walking
