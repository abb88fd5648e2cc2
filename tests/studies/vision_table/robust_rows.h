// The rows of the robustness table: what is asked of the eyes, and where vision is known to break.
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
  bool learn = false;    // the colour from one picture in this light; else ColorRange::red_ball()
  bool clutter = false;  // red and orange things
};

std::vector<RobustCase> robust_cases();

}  // namespace kaz::vision_table
