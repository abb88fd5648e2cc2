// Finds what is wrong with a URDF before the parser sees it: that one reports no lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Elements, names, numbers, tree, masses and limits, against what docs/robot.md says a robot file
// must have.
Result<void> check_urdf(const std::string& path);

}  // namespace kaz::sim
