// Obstacles in the world of an episode.
// SPDX-License-Identifier: Apache-2.0
//
// Frame: between the feet of the robot at its start; x ahead, y left. Units m, rad, s.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

namespace kaz::tools {

enum class Shape { box, can, ball };

// A push at a time after the start of the world. The obstacle slides by `by_m` and stays there.
struct Slide {
  double at_s = 0;
  Eigen::Vector2d by_m{0, 0};
};

// Stands on the floor. A ball can roll, a sliding obstacle is pushed, all others are fixed.
struct Obstacle {
  double x_m = 0, y_m = 0, yaw_rad = 0;
  // For cans and balls, length and width are the diameter; for a ball so is the height.
  double length_m = 0.1, width_m = 0.1, height_m = 0.1;
  Shape shape = Shape::box;
  std::array<double, 3> rgb{0.5, 0.5, 0.5};
  std::optional<Slide> slide = {};

  Eigen::Vector2d place() const { return {x_m, y_m}; }
};

// Returns the distance in m from `place` to the obstacle's wall, seen from above; 0 inside.
double distance_to(const Obstacle& obstacle, const Eigen::Vector2d& place);
// Returns the obstacle after its slide.
Obstacle at_rest(const Obstacle& obstacle);
// Friction coefficient of a sliding obstacle on any floor, and the initial speed in m/s for a slide of
// `distance_m`.
constexpr double kSlideFriction = 0.15;
double push_speed(double distance_m);

}  // namespace kaz::tools
