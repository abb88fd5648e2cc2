// Readings of the gyroscope and the accelerometer, which form the board's option `imu`.
// SPDX-License-Identifier: Apache-2.0
//
// Axes are those of the robot's link `imu`: x forward, y left, z up. The zero offsets differ between boards:
// up to 40 degrees/s for the gyroscope, up to 0.2 g for the accelerometer. Measure the zero offsets at rest
// before you integrate the readings.
#pragma once

#include <numbers>

#include "shared/base/time.hpp"
#include "shared/board/board.h"

namespace kaz::host {

struct Inertial {
  Time time{};                    // host time of the measurement
  double yaw_rate_rad_per_s = 0;  // about z, positive to the left
  // Specific force along x; positive if the robot speeds up or leans back.
  double forward_m_per_s2 = 0;
  double left_m_per_s2 = 0;  // specific force along y
};

// Scale factors of the sensor parts (docs/reference/simulator.md, table of sensors). The outputs of the parts
// are proportional to the converter's reference voltage.
inline constexpr double kYawRatePerCode = std::numbers::pi / 180 / 0.001 / KZ_POT_CODES;
inline constexpr double kForcePerCode = 9.80665 / 0.0624 / KZ_POT_CODES;
// An A/D code below this limit means that the input is grounded. If all three inputs are grounded, the board
// has no inertial sensors.
inline constexpr unsigned kNotFitted = 8;

}  // namespace kaz::host
