// For tests: an inertia on a motor's output shaft. The motor's row is solved in closed form.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/body/motor/joint_motor.h"

namespace kaz::sim::test {

// Loads a motor of the robot Kaz. On an error, the test fails.
inline MotorParams motor_params(const std::string& name = "s9204-jskd04") {
  const auto params = load_motor_file("shared/robot/kaz/motor.xml", name);
  if (!params) {
    ADD_FAILURE() << params.error().message;
    return {};
  }
  return *params;
}

// A shaft with the inertia I, the motor's torque T and an external torque (Nm): I (w1 - w0)/h = T + load.
// Within the bounds of the motor's row, T satisfies w1 + softness * T = velocity.
struct MotorBench {
  explicit MotorBench(const MotorParams& params = motor_params(), double inertia_kgm2 = 1e-4,
                      double step = 1e-3)
      : h(step), inertia(inertia_kgm2), motor(params, step) {}

  void step(double duty, bool powered, double volts, double load) {
    MotorDrive drive;
    drive.duty = duty;
    drive.powered = powered;
    drive.slip_nm = slip_nm;
    const JointMotor::Row row = motor.prepare(drive, volts, angle, speed);
    const double free = speed + h / inertia * load;
    torque = std::clamp((row.velocity - free) / (row.softness + h / inertia), row.min, row.max);
    speed = free + h / inertia * torque;
    angle += h * speed;
    motor.finish(speed, torque);
  }
  void run(double seconds, double duty, bool powered, double volts, double load) {
    for (int i = 0; i < std::lround(seconds / h); ++i) step(duty, powered, volts, load);
  }

  double h, inertia, angle = 0, speed = 0, torque = 0;
  double slip_nm = MotorDrive{}.slip_nm;
  JointMotor motor;
};

}  // namespace kaz::sim::test
