// Validates a URDF before urdfdom parses it, because urdfdom reports no line numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// A root link with this name is fixed at the robot's start pose in the world.
inline constexpr const char* kFixedRoot = "world";

// Contents of the URDF file that urdfdom does not return.
struct UrdfFacts {
  std::vector<std::string> revolute;       // joint names in file order
  std::map<std::string, double> friction;  // mu by link name; contains only links that define mu
  std::string text;                        // the validated file contents, to be parsed by urdfdom
};

// Checks the file against the URDF subset in docs/reference/robot.md. Errors name file and line.
Result<UrdfFacts> check_urdf(const std::string& path);

}  // namespace kaz::sim
