// Distances to what stands about.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/obstacle.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace kaz::tools {

using Eigen::Vector2d;

double distance_to(const Obstacle& o, const Vector2d& place) {
  const Vector2d at = Eigen::Rotation2Dd(-o.yaw_rad) * (place - o.place());
  if (o.shape != Shape::box) return std::max(0.0, at.norm() - o.length_m / 2);
  const Vector2d beyond = (at.cwiseAbs() - Vector2d(o.length_m, o.width_m) / 2).cwiseMax(0.0);
  return beyond.norm();
}

Obstacle at_rest(const Obstacle& obstacle) {
  Obstacle rest = obstacle;
  if (!obstacle.slide) return rest;
  rest.x_m += obstacle.slide->by_m.x();
  rest.y_m += obstacle.slide->by_m.y();
  rest.slide.reset();
  return rest;
}

// Kinetic energy against the work of friction: m v^2 / 2 = mu m g d.
double push_speed(double distance_m) {
  constexpr double kGravity = 9.81;
  return std::sqrt(2 * kSlideFriction * kGravity * distance_m);
}

}  // namespace kaz::tools
