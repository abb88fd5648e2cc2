// Finds what is wrong with a URDF before the parser sees it: that one reports no lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// A root link of this name never moves: the robot is fixed where the world puts it.
inline constexpr const char* kFixedRoot = "world";

// What the file says and the parser does not tell.
struct UrdfFacts {
  std::vector<std::string> revolute;       // names of joints, in the order of the file
  std::map<std::string, double> friction;  // by link: mu of its surfaces
  std::string text;                        // the bytes that were checked, for the parser
};

// Errors name file and line.
Result<UrdfFacts> check_urdf(const std::string& path);

}  // namespace kaz::sim
