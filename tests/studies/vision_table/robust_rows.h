// Rows of the robustness table: conditions that vision must handle, and those in which it is known to fail.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/studies/vision_table/eyes.h"

namespace kaz::vision_table {

struct RobustCase {
  std::string group, name;
  Conditions conditions;
  std::string floor = "wood";
  sim::Rgb ball = sim::kRedBall;
  // Learn the color from one picture in this light. Else it is ColorRange::red_ball().
  bool learn = false;
  bool clutter = false;  // red and orange objects
};

std::vector<RobustCase> robust_cases();

}  // namespace kaz::vision_table
