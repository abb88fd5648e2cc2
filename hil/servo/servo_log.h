// What a servo did with a known weight on its horn: goals, readings, and what the weight was.
// SPDX-License-Identifier: Apache-2.0
//
// A file is CSV: lines `# name value` first, then a line of column names, then numbers.
//   # mass_kg 0.567          at the end of the arm
//   # length_m 0.17          from the shaft to the mass
//   # arm_kg 0.016           a uniform rod of that length; 0 if left out
//   # gain_per_rad 5.3       duty for each rad between goal and position, by the servo's law
//   # most_duty 0.97         1 if left out
//   time_s,goal_rad,position_rad,volts,current_a,torque_on
// position_rad: 0 hanging down. volts: the supply. current_a: through the motor, with the sign of the duty;
// the column may be left out. torque_on: 0 or 1; 1 if left out.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::hil {

struct ServoSample {
  double time_s = 0, goal_rad = 0, position_rad = 0, volts = 0, current_a = 0;
  bool torque_on = true;
};

struct ServoLog {
  std::string name;
  double mass_kg = 0, length_m = 0, arm_kg = 0;
  double gain_per_rad = 0, most_duty = 1;
  bool has_current = false;
  std::vector<ServoSample> samples;  // at least 2, of growing time

  double load_kgm2() const;   // inertia of mass and arm about the shaft
  double gravity_nm() const;  // torque of their weight with the arm horizontal
};

// Errors (usage) name file and line. Bounds: 1 s to 600 s, steps of 0.5 s at most, 200,000 samples.
Result<ServoLog> parse_servo_log(const std::string& text, const std::string& name);
std::string servo_log_text(const ServoLog& log);

}  // namespace kaz::hil
