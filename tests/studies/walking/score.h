// What counts as done, how sure a share is, and the table.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/studies/walking/course.h"

namespace kaz::walking {

// No fall, and the end within 10 % of the distance and 8 degrees of heading; of a turn: within 6
// degrees; of standing: no fall; of getting up: it stands.
bool succeeded(const Trial& trial, const Outcome& outcome);

// Markdown, a line for each trial that has outcomes.
std::string table(const gait::Results& results, const std::vector<Trial>& trials,
                  const std::string& variant);
// Where the robot believed to be at the end of a walk, against the truth: millimetres, degrees, and how
// large the error is in its own sigmas (root mean square; 1 where they are right).
std::string odometry_table(const gait::Results& results, const std::vector<Trial>& trials,
                           const std::string& variant);
std::string summary_json(const gait::Results& results, const std::vector<Trial>& trials,
                         const std::string& variant);
// walking_paths.svg and .png in `folder`: paths from above, with and without gyro; and the turns.
Result<void> pictures(const gait::Results& results, const std::string& variant,
                      const std::string& folder);

}  // namespace kaz::walking
