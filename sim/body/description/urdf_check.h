// Validates a URDF before urdfdom parses it, because urdfdom reports no line numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// If the root link has this name, the root link is fixed in the world, at the robot's start pose.
inline constexpr const char* kFixedRoot = "world";

// Data from the URDF file that urdfdom does not return.
struct UrdfFacts {
  std::vector<std::string> revolute;  // joint names in file order
  // Friction coefficient mu of each link that defines mu, by link name.
  std::map<std::string, double> friction;
  std::string text;  // the validated file contents, to be parsed by urdfdom
};

// Checks the file against the URDF subset in docs/reference/robot.md. An error message names file and line.
Result<UrdfFacts> check_urdf(const std::string& path);

}  // namespace kaz::sim
