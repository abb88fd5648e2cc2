// What stands about in an episode's world.
// SPDX-License-Identifier: Apache-2.0
//
// Frame: from between the feet of the robot at its start; x ahead, y left. Units m, rad, s.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

namespace kaz::tools {

enum class Shape { box, can, ball };

// A push at a time after the start of the world, after which it slides by so much and stays.
struct Slide {
  double at_s = 0;
  Eigen::Vector2d by_m{0, 0};
};

// Stands on the floor; a ball is free to roll, what slides is pushed, all else is fixed.
struct Obstacle {
  double x_m = 0, y_m = 0, yaw_rad = 0;
  // Of cans and balls, length and width are the diameter; of a ball so is the height.
  double length_m = 0.1, width_m = 0.1, height_m = 0.1;
  Shape shape = Shape::box;
  std::array<double, 3> rgb{0.5, 0.5, 0.5};
  std::optional<Slide> slide = {};

  Eigen::Vector2d place() const { return {x_m, y_m}; }
};

// m, from a place to the obstacle's wall, seen from above; 0 inside.
double distance_to(const Obstacle& obstacle, const Eigen::Vector2d& place);
// As it stands after its slide.
Obstacle at_rest(const Obstacle& obstacle);
// The friction coefficient of what slides, on any floor; and the speed of a push that slides it so far, m/s.
constexpr double kSlideFriction = 0.15;
double push_speed(double distance_m);

}  // namespace kaz::tools
