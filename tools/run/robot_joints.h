// Joints of a robot other than Kaz, from its URDF file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Returns the joint names of `robot_file` (URDF) in the order of the board's channels. Returns an empty list
// for Kaz and for an empty path. Fails (usage) if the robot's files are not valid, or if the robot has more
// joints than the board has channels.
Result<std::vector<std::string>> other_joints(const std::string& robot_file);

// Returns the speed limits of these joints as text, rad/s: at most 12, the board's largest ramp. Returns an
// empty list if no joint has a lower limit.
Result<std::vector<std::string>> joint_speeds(const std::string& robot_file);
// Parses such a list. Fails (usage) if a text is not a number above 0.
Result<std::vector<double>> parse_speeds(const std::vector<std::string>& texts);

// Prints one line to standard error if robot and joints in `robot_file` have elements that Kaz does not use.
// Elements of links are left out. `label`: prefix of the line. Ignores an empty path and an invalid file.
void print_unused(const std::string& label, const std::string& robot_file);

// Prints the same line about a world file. `world`: path, or a name as in world_file(). Ignores an invalid
// file.
void print_unused_of_world(const std::string& label, const std::string& world);

}  // namespace kaz::tools
