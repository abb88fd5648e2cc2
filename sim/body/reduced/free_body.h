// A free rigid body, such as a ball or a box.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/body/description/rigid_link.h"
#include "sim/body/world/body_sleep.h"
#include "sim/body/world/saved_pose.h"

namespace kaz::sim {

// The state contains angular momentum instead of angular velocity, so that angular momentum is exactly
// constant in flight.
class FreeBody {
 public:
  FreeBody(const RigidLink& link, const Eigen::Isometry3d& start);

  // Position (m) and velocity (m/s) of the center of mass, in the world frame.
  Eigen::Vector3d com;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& angular_velocity() const { return angular_velocity_; }
  const Eigen::Matrix3d& axes() const { return axes_; }  // axes of the link's frame in the world
  Eigen::Isometry3d link_pose() const;
  double mass() const { return mass_; }

  Eigen::Matrix3d inertia() const { return axes_ * inertia_ * axes_.transpose(); }  // world axes

  // Advances the body by one step. `velocity_after` and `angular_after` are the velocities after the impulses
  // of the step. `flight` is true if no contact acted on the body.
  void advance(const Eigen::Vector3d& velocity_after, const Eigen::Vector3d& angular_after,
               bool flight, double step_s);
  // Sets the velocities after an impact or a push at the present pose: m/s and rad/s, world axes.
  void strike(const Eigen::Vector3d& velocity_after, const Eigen::Vector3d& angular_after);
  void stop();

  bool awake = true;
  double left_s = SleepRule{}.after_s;  // remaining time at rest before the body is put to sleep

  // Archives the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    for (int k = 0; k < 3; ++k) a(com[k], velocity[k], momentum_[k]);
    for (int k = 0; k < 4; ++k) a(turn_.coeffs()[k]);
    a(awake, left_s);
    a.require(is_saved_place(com) && is_saved_motion(velocity) && is_saved_motion(momentum_) &&
                  is_saved_turn(turn_),
              "body pose");
    if constexpr (A::reading) place();
  }

 private:
  void place();
  void add_spin(const Eigen::Vector3d& change);
  Eigen::Vector3d turning(const Eigen::Quaterniond& turn) const;

  double mass_;
  Eigen::Vector3d own_com_;
  // Inertia tensor about the center of mass, in the body's own axes, and the inverse of this tensor.
  Eigen::Matrix3d inertia_, inverse_;
  Eigen::Quaterniond turn_;
  Eigen::Vector3d momentum_ = Eigen::Vector3d::Zero();
  // Derived from the state by place().
  Eigen::Vector3d angular_velocity_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes_;
};

// Returns `turn` rotated by the rotation vector `by` (rad, world axes).
Eigen::Quaterniond turned(const Eigen::Quaterniond& turn, const Eigen::Vector3d& by);

}  // namespace kaz::sim
