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

enum class Motion { sine_of_square, lift_and_drop, up_and_down, two_sines, steps };

// Effects of a real STS3215 (shared/servo_model), which swing() adds to the servo.
struct Planted {
  double delay = 0;     // s, until a goal acts
  double slew = 1e9;    // rad/s, of the setpoint
  double lag = 0;       // s, of the duty
  double coasting = 0;  // N m, friction without torque
  double zero = 0;      // rad, reading while the arm hangs straight down
  // Without the effects that no model has, a fit must find the planted values.
  bool plain = false;
};

// Simulates a servo with parameters drawn from `seed`. The servo is about as large as an XL330 (even seeds)
// or an MX-64 (odd seeds). Friction: bristles yield before sliding, and gears lose more torque when driven
// backwards. Motor: torque ripple, and a winding that warms up. Other effects are: the pull of a cable, a
// dead zone of the control law, quantized readings, and timestamps with drift and offset.
Swing swing(std::uint64_t seed, Motion motion, double mass_share, double gain_share,
            double seconds = 6, const Planted& planted = {});

}  // namespace kaz::hil::truth
