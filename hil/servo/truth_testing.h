// Servos with effects that no fitted model has, to judge fits by. Shares no code with them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
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

// A servo drawn by `seed`, about the size of an XL330 (even seeds) or an MX-64 (odd ones): bristles that
// give way before they slide, gears that lose more when they are driven back, ripple of the motor's torque, a
// cable that pulls, a winding that warms, a law with a dead zone, steps of the sensor, a late clock.
Swing swing(std::uint64_t seed, Motion motion, double mass_share, double gain_share,
            double seconds = 6);

}  // namespace kaz::hil::truth
