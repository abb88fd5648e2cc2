// Goal of the behavior navigate, parsed from its option.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

namespace kaz::behavior {

// The goal is either a position on the floor with an optional heading, or the ball.
struct NavigationGoal {
  bool ball = false;                  // true: the goal is the ball; other members are unused
  Eigen::Vector2d position{0, 0};     // m, relative to the robot's start; x ahead, y left
  std::optional<double> heading_rad;  // empty: any heading
};

// Parses "X,Y", "X,Y,HEADING" (m, degrees) or "ball". Returns nothing for other text, for a position more
// than 3 m away, or for a heading beyond 360 degrees.
std::optional<NavigationGoal> navigation_goal(std::string_view text);
bool is_navigation_goal(std::string_view text);

}  // namespace kaz::behavior
