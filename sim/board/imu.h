// The board's optional inertial sensors at AN3..AN5: yaw-rate gyro and two-axis accelerometer.
// SPDX-License-Identifier: Apache-2.0
//
// Each axis adds white noise to the measured quantity, filters the sum with a first-order low-pass, and
// applies offset, scale and saturation. The offset is the sum of a constant and a random drift. The constant
// differs from sensor to sensor. The drift is a first-order Gauss-Markov process. The first value of the
// drift has the stationary distribution. If the drift is `x` in one tick, the drift `x'` in the next tick is:
//
//   x' = e x + sigma sqrt(1 - e^2) n,  e = exp(-1 ms / time)
//
// The low-pass is computed exactly for an input that is constant within each millisecond. White noise has the
// one-sided density N. The bandwidth of samples at 1 kHz is 500 Hz, half the sampling rate. So the noise of
// each sample has a normal distribution with the standard deviation `N * sqrt(1000 / 2)`.
#pragma once

#include <array>
#include <cstdint>

#include "sim/board/sensor_file.h"

namespace kaz::sim {

// Motion in the axes of the robot's link `imu` (docs/reference/robot.md): x forward, y left, z up.
struct ImuMotion {
  double yaw_rate = 0;                       // angular velocity about z, rad/s
  double forward_force = 0, left_force = 0;  // specific force along x and y, m/s^2
};

class Imu {
 public:
  Imu(const SensorParams& params, const SensorSwitches& switches, std::uint64_t seed);

  // Processes the motion during the millisecond that ends with `tick`. The ticks of successive calls must
  // increase.
  void advance(std::int64_t tick, const ImuMotion& motion);

  // Copies the filtered motion of `other`, but not the sensor errors of `other`.
  void follow(const Imu& other);

  // Returns the output as a fraction of AVCC, 0..1. Axes: 0 yaw rate (AN3), 1 forward (AN4), 2 left (AN5).
  double ratio(int axis) const;

  // Archives the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(started_);
    for (Axis& axis : axes_) {
      a(axis.filtered);
      a(axis.wandered);
    }
  }

 private:
  struct Axis {
    ImuAxisParams params;
    bool real = false;  // true if the sensor has errors
    double offset = 0, sigma = 0, follow = 1, filtered = 0;
    // Values for the formula at the top of this file: `stay` is `e`, `stir` is `sigma sqrt(1 - e^2)`, and
    // `wandered` is `x`.
    double stay = 1, stir = 0, wandered = 0;
  };
  std::uint64_t seed_;
  bool started_ = false;
  std::array<Axis, 3> axes_;
};

}  // namespace kaz::sim
