// Converts swings of truth_testing.h to logs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/servo/servo_log.h"
#include "hil/servo/truth_testing.h"

namespace kaz::hil {

inline ServoLog log_of(const truth::Swing& swing) {
  ServoLog log;
  log.mass_kg = swing.mass_kg;
  log.length_m = swing.length_m;
  log.arm_kg = swing.arm_kg;
  log.gain_per_rad = swing.gain_per_rad;
  log.most_duty = swing.most_duty;
  log.has_current = true;
  for (const truth::Reading& r : swing.readings)
    log.samples.push_back(
        {r.time_s, r.goal_rad, r.position_rad, r.volts, r.current_a, r.torque_on});
  return log;
}

// A log of a pendulum that rests, with goal 0.
inline ServoLog still_pendulum(double seconds, double step = 0.01) {
  ServoLog log;
  log.mass_kg = 0.4;
  log.length_m = 0.15;
  log.gain_per_rad = 4;
  for (int i = 0; i * step <= seconds; ++i) log.samples.push_back({i * step, 0, 0, 12, 0, true});
  return log;
}

}  // namespace kaz::hil
