// The board option of AN3..AN5: yaw-rate gyro and two-axis accelerometer.
// SPDX-License-Identifier: Apache-2.0
//
// Each axis: white noise is added to the measured quantity, both are low-pass filtered (first order), then
// offset, scale and saturation are applied. The offset is a constant of the part plus a first-order
// Gauss-Markov process, x' = e x + sigma sqrt(1 - e^2) n with e = exp(-1 ms / time), started in its
// stationary distribution. The filter is exact for an input that is constant within a millisecond. White
// noise of one-sided density N sampled at 1 kHz is normal with sigma N sqrt(1000 / 2), since its bandwidth
// is half the sampling rate.
#pragma once

#include <array>
#include <cstdint>

#include "sim/board/sensor_file.h"

namespace kaz::sim {

// In the axes of the robot's link `imu` (docs/reference/robot.md): x forward, y left, z up.
struct ImuMotion {
  double yaw_rate = 0;                       // rad/s about z
  double forward_force = 0, left_force = 0;  // specific force along x and y, m/s^2
};

class Imu {
 public:
  Imu(const SensorParams& params, const SensorSwitches& switches, std::uint64_t seed);

  // The motion during the millisecond that ends with this tick. Ticks must increase.
  void advance(std::int64_t tick, const ImuMotion& motion);

  // Goes on with the motion that another has measured so far, with errors of its own.
  void follow(const Imu& other);

  // Fractions of AVCC, 0..1, at AN3 (yaw rate), AN4 (forward), AN5 (left): axis 0, 1, 2.
  double ratio(int axis) const;

  // Complete state (archive.hpp).
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
    bool real = false;  // with its errors
    double offset = 0, sigma = 0, follow = 1, filtered = 0;
    double stay = 1, stir = 0, wandered = 0;  // per millisecond
  };
  std::uint64_t seed_;
  bool started_ = false;
  std::array<Axis, 3> axes_;
};

}  // namespace kaz::sim
