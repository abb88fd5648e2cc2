// Goal of the behavior navigate, parsed from its option.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

namespace kaz::behavior {

// A position and optional heading on the floor, or the ball.
struct NavigationGoal {
  bool ball = false;
  Eigen::Vector2d position{0, 0};     // m, from the start; x ahead, y left
  std::optional<double> heading_rad;  // empty: any
};

// Parses "X,Y", "X,Y,HEADING" (m, degrees) or "ball". Returns nothing for other text, a position farther
// than 3 m, or a heading beyond 360 degrees.
std::optional<NavigationGoal> navigation_goal(std::string_view text);
bool is_navigation_goal(std::string_view text);

}  // namespace kaz::behavior
