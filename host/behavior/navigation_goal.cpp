// Reads goals.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/navigation_goal.h"

#include <cmath>
#include <vector>

#include "shared/base/angle.hpp"
#include "shared/base/number_text.hpp"

namespace kaz::behavior {

namespace {

constexpr double kFarthest = 3;  // m

}  // namespace

std::optional<NavigationGoal> navigation_goal(std::string_view text) {
  NavigationGoal goal;
  goal.ball = text == "ball";
  if (goal.ball) return goal;
  std::vector<double> numbers;
  for (bool more = true; more;) {
    const auto comma = text.find(',');
    const auto number = parse_number<double>(text.substr(0, comma));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    more = comma != std::string_view::npos;
    if (more) text.remove_prefix(comma + 1);
  }
  if (numbers.size() < 2 || numbers.size() > 3) return std::nullopt;
  goal.position = {numbers[0], numbers[1]};
  if (goal.position.norm() > kFarthest) return std::nullopt;
  if (numbers.size() == 3) {
    if (std::abs(numbers[2]) > 360) return std::nullopt;
    goal.heading_rad = numbers[2] * kDegree;
  }
  return goal;
}

bool is_navigation_goal(std::string_view text) {
  return navigation_goal(text).has_value();
}

}  // namespace kaz::behavior
