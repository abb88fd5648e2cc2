// Finds what is wrong with a URDF before the parser sees it: that one reports no lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// A root link of this name never moves: the robot is fixed where the world puts it.
inline constexpr const char* kFixedRoot = "world";

// Names of the revolute joints, in the order of the file. Errors name file and line.
Result<std::vector<std::string>> check_urdf(const std::string& path);

}  // namespace kaz::sim
