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
//   # inertia_kgm2 0.0185
//   # gravity_nm 1.02
//   # motion chirp
//   time_s,goal_rad,position_rad,volts,current_a,torque_on
//
// - `mass_kg`: mass at the end of the arm.
// - `length_m`: distance from the shaft to the mass.
// - `arm_kg`: mass of the arm, which is a uniform rod of length `length_m`; default 0.
// - `gain_per_rad`: gain of the servo's control law, 1/rad. The duty is this gain times (goal - position).
// - `most_duty`: maximum duty; default 1.
// - `inertia_kgm2`: inertia of mass and arm about the shaft; default: computed from mass and length. The
//   inertia of a CAD model is better, because a real rig is no point mass on a thin rod.
// - `gravity_nm`: torque of the weight while the arm is horizontal; default: computed.
// - `motion`: name of the motion; default: words of the file's name that contain no digit.
// - `position_rad`: angle of the arm; about 0 when the arm hangs down.
// - `volts`: supply voltage.
// - `current_a`: motor current with the sign of the duty; optional column.
// - `torque_on`: 0 or 1; default 1.
//
// Logs of BAM (Rhoban/bam) are JSON. The head has mass (kg), length (m), arm_mass, kp, motor, trajectory.
// Each entry has position, goal_position, input_volts, timestamp and torque_enable.
//
// Impossible samples are repaired and counted. A voltage further than 25 % from the log's median becomes the
// median. A single position far from both neighbors becomes their mean.
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
  double inertia_kgm2 = 0, weight_nm = 0;  // values of the header; 0: computed from mass and length
  std::string motion;
  bool has_current = false;
  bool unsigned_current = false;  // the log has currents, but without the duty's sign
  int repaired_volts = 0, repaired_positions = 0;
  std::vector<ServoSample> samples;  // at least two samples, sorted by time

  double load_kgm2() const;   // inertia of mass and arm about the shaft
  double gravity_nm() const;  // torque of the weight of mass and arm when the arm is horizontal
  std::string rig() const;    // name of the weight, such as "0.741 kg, 0.15 m"
};

// Parses a log, CSV or BAM's JSON. Errors (usage) name file and line. Limits: The log lasts 1 to 600 s.
// Successive samples are at most 0.5 s apart. The log has at most 200,000 samples.
Result<ServoLog> parse_servo_log(const std::string& text, const std::string& name);

// Marks currents without sign as unused. The currents of one log can look right by chance. So if one log's
// currents have no sign, this applies to all logs without negative currents.
void drop_unsigned_currents(std::vector<ServoLog>& logs);

std::string servo_log_text(const ServoLog& log);

}  // namespace kaz::hil
