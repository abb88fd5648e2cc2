// Where navigate is to go.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

namespace kaz::behavior {

struct NavigationGoal {
  bool ball = false;
  Eigen::Vector2d position{0, 0};     // m, frame of the start
  std::optional<double> heading_rad;  // none: any
};

// "X,Y", "X,Y,HEADING" (m, degrees) or "ball"; nothing for another text, or a goal farther than 3 m.
std::optional<NavigationGoal> navigation_goal(std::string_view text);
bool is_navigation_goal(std::string_view text);

}  // namespace kaz::behavior
