// The motion of a virtual DYNAMIXEL: from its registers and its position sensor to the duty of its motor.
// SPDX-License-Identifier: Apache-2.0
//
// Positions in pulses, speeds in pulses/s, PWM in units of the registers (885 is all), in the direction of
// the registers, which drive_mode can reverse against the servo's own.
//
// Documented: modes, limits, units, the profile, the laws of the loops and what their gains are divided by;
// of the XL330's P gain, what Rhoban measured. Chosen: a period of 1 ms, hence the units of the D, I and
// feedforward gains (per ms); the current loop; how mode 5 scales its current; the thresholds of
// moving_status.
#pragma once

#include "sim/body/motor/motor_drive.h"
#include "sim/bus/register_file.h"
#include "sim/bus/servo_reading.h"
#include "sim/bus/trajectory.h"

namespace kaz::sim {

class DynamixelMotion {
 public:
  // One step. Updates the registers of motion. `stopped`: by the bus watchdog.
  MotorDrive step(RegisterFile& registers, const ServoReading& reading, double step_s,
                  bool stopped);

  void power_on(RegisterFile& registers, const ServoReading& reading);
  // The torque was switched on: it holds where it is.
  void switch_on(RegisterFile& registers);
  // A host has written a goal.
  void goal_written(const RegisterFile& registers);
  // operating_mode was written: gains, profile and goals begin anew.
  void mode_written(RegisterFile& registers);
  // Forgets the turns counted. False: the shaft turns.
  bool clear_turns(RegisterFile& registers);

  double duty() const { return duty_; }  // in the servo's direction

 private:
  enum Mode { current = 0, velocity = 1, position = 3, turns = 4, current_position = 5, pwm = 16 };
  static double sign(const RegisterFile& registers);
  static int offset(const RegisterFile& registers);
  double raw(const RegisterFile& registers) const;
  int place(const RegisterFile& registers) const;
  void wrap(const RegisterFile& registers);
  void hold(RegisterFile& registers);
  double position_loop(const RegisterFile& registers, double step_s);
  double velocity_loop(const RegisterFile& registers, double step_s);
  void report(RegisterFile& registers) const;

  ServoReading reading_;
  double origin_ = 0;  // of the turns counted
  Trajectory trajectory_;
  double profile_speed_ = 0, profile_rate_ = 0;  // of the motion under way; speed 0: no profile
  int shape_ = 0;                                // of it, as in moving_status
  double integral_ = 0;                          // PWM
  double pwm_ = 0, duty_ = 0;
  bool powered_ = false;
};

}  // namespace kaz::sim
