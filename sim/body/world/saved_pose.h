// Limits of poses and velocities in a saved state. With a value beyond these limits, the solver or the
// collision detection might run forever.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace kaz::sim {

// Returns whether a position (m) is within the limits. The limit is larger than the distance that a body
// falls in a day.
inline bool is_saved_place(const Eigen::Vector3d& at) {
  return at.cwiseAbs().maxCoeff() < 1e11;
}
// Returns whether a velocity (m/s or rad/s) is within the limits.
inline bool is_saved_motion(const Eigen::Vector3d& velocity) {
  return velocity.cwiseAbs().maxCoeff() < 1e7;
}
inline bool is_saved_turn(const Eigen::Quaterniond& turn) {
  return std::abs(turn.squaredNorm() - 1) < 1e-6;
}

}  // namespace kaz::sim
