// Obstacles in the world of an episode.
// SPDX-License-Identifier: Apache-2.0
//
// Coordinate frame: origin between the feet of the robot at the start; x ahead, y left. Units: m, rad, s.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

namespace kaz::tools {

enum class Shape { box, can, ball };

// A push at the time `at_s` after the start of the simulation. The obstacle slides by `by_m` and then stays.
struct Slide {
  double at_s = 0;
  Eigen::Vector2d by_m{0, 0};
};

// An object that stands on the floor. A ball can roll, an obstacle with `slide` is pushed, and all other
// obstacles are fixed.
struct Obstacle {
  double x_m = 0, y_m = 0, yaw_rad = 0;
  // For a can, length and width are the diameter. For a ball, length, width and height are the diameter.
  double length_m = 0.1, width_m = 0.1, height_m = 0.1;
  Shape shape = Shape::box;
  std::array<double, 3> rgb{0.5, 0.5, 0.5};
  std::optional<Slide> slide = {};

  Eigen::Vector2d place() const { return {x_m, y_m}; }
};

// Returns the distance in m from `place` to the obstacle's wall, seen from above; 0 inside.
double distance_to(const Obstacle& obstacle, const Eigen::Vector2d& place);
// Returns the obstacle at its position after the slide.
Obstacle at_rest(const Obstacle& obstacle);
// kSlideFriction: friction coefficient of a sliding obstacle on any floor. push_speed() returns the initial
// speed in m/s that makes the obstacle slide by `distance_m`.
constexpr double kSlideFriction = 0.15;
double push_speed(double distance_m);

}  // namespace kaz::tools
