// Log of a servo that moves a known weight: goals, readings and the weight.
// SPDX-License-Identifier: Apache-2.0
//
// A log file is CSV. The file begins with lines `# name value`. The next line contains the column names. All
// further lines contain numbers.
//
//   # mass_kg 0.567
//   # length_m 0.17
//   # arm_kg 0.016
//   # gain_per_rad 5.3
//   # most_duty 0.97
//   time_s,goal_rad,position_rad,volts,current_a,torque_on
//
// - `mass_kg`: mass at the end of the arm.
// - `length_m`: distance from the shaft to the mass.
// - `arm_kg`: mass of the arm, which is a uniform rod of length `length_m`; default 0.
// - `gain_per_rad`: gain of the servo's control law, 1/rad. The duty is this gain times (goal - position).
// - `most_duty`: maximum duty; default 1.
// - `position_rad`: angle of the arm; 0 when the arm hangs down.
// - `volts`: supply voltage.
// - `current_a`: motor current with the sign of the duty; optional column.
// - `torque_on`: 0 or 1; default 1.
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
  std::vector<ServoSample> samples;  // at least two samples, sorted by time

  double load_kgm2() const;   // inertia of mass and arm about the shaft
  double gravity_nm() const;  // torque of the weight of mass and arm when the arm is horizontal
};

// Parses a log. Errors (usage) name the file and the line. Limits: The log lasts 1 to 600 s. Successive
// samples are at most 0.5 s apart. The log has at most 200,000 samples.
Result<ServoLog> parse_servo_log(const std::string& text, const std::string& name);
std::string servo_log_text(const ServoLog& log);

}  // namespace kaz::hil
