// Readings of gyro and accelerometer, the board's option `imu`.
// SPDX-License-Identifier: Apache-2.0
//
// In the axes of the robot's link `imu`: x forward, y left, z up. The gyro has an
// offset of up to 40 degrees/s, the accelerometer of up to 0.2 g, different for each board: measure the
// offset at rest before integrating.
#pragma once

#include <numbers>

#include "shared/board/board.h"
#include "vision/image/frame.h"  // Time

namespace kaz::host {

struct Inertial {
  Time time{};                    // host time at which the board measured it
  double yaw_rate_rad_per_s = 0;  // about z, + to the left
  double forward_m_per_s2 = 0;    // specific force along x: + while it speeds up or leans back
  double left_m_per_s2 = 0;       // the same along y
};

// The parts' laws (docs/reference/simulator.md, table of sensors): shares of the converter's reference.
inline constexpr double kYawRatePerCode = std::numbers::pi / 180 / 0.001 / KZ_POT_CODES;
inline constexpr double kForcePerCode = 9.80665 / 0.0624 / KZ_POT_CODES;
// Codes below this on all three inputs: they are grounded, the option is not fitted.
inline constexpr unsigned kNotFitted = 8;

}  // namespace kaz::host
