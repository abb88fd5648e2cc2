// Readings of gyroscope and accelerometer, the board's option `imu`.
// SPDX-License-Identifier: Apache-2.0
//
// In the axes of the robot's link `imu`: x forward, y left, z up. Each board has its own offsets: up to 40
// degrees/s for the gyroscope, up to 0.2 g for the accelerometer. Measure them at rest before integrating.
#pragma once

#include <numbers>

#include "shared/board/board.h"
#include "vision/image/frame.h"  // Time

namespace kaz::host {

struct Inertial {
  Time time{};                    // host time of the measurement
  double yaw_rate_rad_per_s = 0;  // about z, positive to the left
  double forward_m_per_s2 = 0;    // specific force along x: positive if it speeds up or leans back
  double left_m_per_s2 = 0;       // specific force along y
};

// Scale factors of the parts (docs/reference/simulator.md, table of sensors). Outputs are ratiometric to the
// converter's reference.
inline constexpr double kYawRatePerCode = std::numbers::pi / 180 / 0.001 / KZ_POT_CODES;
inline constexpr double kForcePerCode = 9.80665 / 0.0624 / KZ_POT_CODES;
// If all three codes are below this, the inputs are grounded and the option is not fitted.
inline constexpr unsigned kNotFitted = 8;

}  // namespace kaz::host
