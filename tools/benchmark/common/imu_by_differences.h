// Computes IMU readings from differences of the IMU's pose, for physics engines without an IMU.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "sim/body/world/world.h"

namespace kaz::sim::bench {

class ImuByDifferences {
 public:
  // Sets the first pose of the IMU in the world. The IMU is at rest.
  void start(const Eigen::Isometry3d& at) { at_ = at; }
  // Returns the readings after a step with a duration of step_s. `at`: pose of the IMU in the world.
  // `gravity`: gravity in the world frame, m/s^2.
  ImuState read(const Eigen::Isometry3d& at, double step_s, const Eigen::Vector3d& gravity) {
    ImuState state;
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(at_.linear().transpose() * at.linear()));
    const Eigen::Vector3d velocity = (at.translation() - at_.translation()) / step_s;
    state.angular_velocity = turn.axis() * turn.angle() / step_s;
    state.specific_force = at.linear().transpose() * ((velocity - velocity_) / step_s - gravity);
    at_ = at;
    velocity_ = velocity;
    return state;
  }

 private:
  Eigen::Isometry3d at_ = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
};

}  // namespace kaz::sim::bench
