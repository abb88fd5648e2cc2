// Validates a URDF before the parser reads it, which reports no line numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// A root link of this name is fixed at the robot's pose in the world.
inline constexpr const char* kFixedRoot = "world";

// Contents of the file that the parser does not return.
struct UrdfFacts {
  std::vector<std::string> revolute;       // names of joints, in the order of the file
  std::map<std::string, double> friction;  // by link: mu of its surfaces
  std::string text;                        // the bytes that were checked, for the parser
};

// Errors name file and line.
Result<UrdfFacts> check_urdf(const std::string& path);

}  // namespace kaz::sim
