// Joints of a robot other than Kaz, from the file that its user gives, at a port as in the simulator.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Names of the joints of `robot_file` (URDF) in the order of the board's channels; none for Kaz, which is
// also the robot without a file. Errors (usage): as of the robot's files; more joints than the board has
// channels.
Result<std::vector<std::string>> other_joints(const std::string& robot_file);

}  // namespace kaz::tools
