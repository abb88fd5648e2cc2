// A free rigid body: a ball, a box.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/free_body.h"

#include <cmath>

#include <Eigen/LU>

namespace kaz::sim {

// Exponential map: rotation by |by| about by / |by|, then normalised.
Eigen::Quaterniond turned(const Eigen::Quaterniond& turn, const Eigen::Vector3d& by) {
  const double angle = by.norm();
  const double part = angle > 1e-12 ? std::sin(angle / 2) / angle : 0.5;
  const Eigen::Quaterniond step(std::cos(angle / 2), part * by.x(), part * by.y(), part * by.z());
  return (step * turn).normalized();
}

FreeBody::FreeBody(const RigidLink& link, const Eigen::Isometry3d& start)
    : com(start * link.com),
      mass_(link.mass),
      own_com_(link.com),
      inertia_(link.inertia),
      inverse_(link.inertia.inverse()),
      turn_(start.linear()) {
  turn_.normalize();
  place();
}

Eigen::Isometry3d FreeBody::link_pose() const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = axes_;
  pose.translation() = com - axes_ * own_com_;
  return pose;
}

void FreeBody::place() {
  axes_ = turn_.toRotationMatrix();
  angular_velocity_ = turning(turn_);
}

// Angular velocity at orientation `turn`: w = R I^-1 R^T L, world axes, rad/s.
Eigen::Vector3d FreeBody::turning(const Eigen::Quaterniond& turn) const {
  return turn * (inverse_ * (turn.conjugate() * momentum_));
}

// Position: trapezoidal rule in flight, exact under gravity; the new velocity in contact, so that the
// solver's contact constraints hold. Rotation: midpoint rule on w = R I^-1 R^T L, second order.
void FreeBody::advance(const Eigen::Vector3d& velocity_after, const Eigen::Vector3d& angular_after,
                       bool flight, double step_s) {
  add_spin(angular_after - angular_velocity_);
  com += step_s * (flight ? Eigen::Vector3d((velocity + velocity_after) / 2) : velocity_after);
  velocity = velocity_after;
  const Eigen::Quaterniond halfway = turned(turn_, step_s / 2 * turning(turn_));
  turn_ = turned(turn_, step_s * turning(halfway));
  place();
}

void FreeBody::add_spin(const Eigen::Vector3d& change) {
  momentum_ += axes_ * (inertia_ * (axes_.transpose() * change));
}

void FreeBody::strike(const Eigen::Vector3d& velocity_after, const Eigen::Vector3d& angular_after) {
  add_spin(angular_after - angular_velocity_);
  velocity = velocity_after;
  place();
}

void FreeBody::stop() {
  velocity.setZero();
  momentum_.setZero();
  angular_velocity_.setZero();
}

}  // namespace kaz::sim
