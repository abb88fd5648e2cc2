// Simulated servos for tests of fits. The code is independent of the fitted models.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace kaz::hil::truth {

struct Reading {
  double time_s, goal_rad, position_rad, volts, current_a;
  bool torque_on;
};

struct Swing {
  double mass_kg, length_m, arm_kg, gain_per_rad, most_duty;
  std::vector<Reading> readings;
};

enum class Motion { sine_of_square, lift_and_drop, up_and_down, two_sines };

// Simulates a servo with parameters drawn from `seed`. The servo is about as large as an XL330 (even seeds)
// or an MX-64 (odd seeds). Friction: bristles yield before sliding, and gears lose more torque when driven
// backwards. Motor: torque ripple, and a winding that warms up. Other effects are: the pull of a cable, a
// dead zone of the control law, quantized readings, and timestamps with drift and offset.
Swing swing(std::uint64_t seed, Motion motion, double mass_share, double gain_share,
            double seconds = 6);

}  // namespace kaz::hil::truth
