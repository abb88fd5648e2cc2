// Motion control of a virtual DYNAMIXEL: computes the duty of the motor from registers and position sensor.
// SPDX-License-Identifier: Apache-2.0
//
// Positions are in pulses and speeds in pulses/s. PWM values are in the unit of the registers, in which 885
// means 100 %. All these values have the same sign as in the registers. If bit 0 of the register drive_mode
// is set, a positive register value means the negative direction of the servo.
//
// The maker documents modes, limits, units, the profile, the control laws and the divisors of the gains.
// Rhoban (a robotics team) measured the divisor of the XL330's P gain.
//
// An identified servo has its own law in modes 3 and 4: command delay, slew limit, duty and lag
// (identified_law.h). The profile acts on top of it.
//
// We chose the control period of 1 ms, the current loop, the current scale of mode 5, and the thresholds of
// moving_status. The D, I and feedforward gains count time in control periods, so their unit of time is 1 ms.
#pragma once

#include <optional>
#include <utility>

#include "sim/body/motor/motor_drive.h"
#include "sim/bus/identified_law.h"
#include "sim/bus/register_file.h"
#include "sim/bus/servo_reading.h"
#include "sim/bus/trajectory.h"

namespace kaz::sim {

class DynamixelMotion {
 public:
  // Advances by one step and updates the registers that describe the motion. `stopped` is true if the bus
  // watchdog has tripped.
  MotorDrive step(RegisterFile& registers, const ServoReading& reading, double step_s,
                  bool stopped);

  void power_on(RegisterFile& registers, const ServoReading& reading);
  // Call after the torque was switched on. The servo then holds the present position.
  void switch_on(RegisterFile& registers);
  // Call after a host has written a goal.
  void goal_written(const RegisterFile& registers);
  // Call after operating_mode was changed: resets gains, profile and goals.
  void mode_written(RegisterFile& registers);
  // Sets the number of counted turns to 0. If the register `moving` is set, does nothing and returns false.
  bool clear_turns(RegisterFile& registers);

  void use_law(IdentifiedLaw::Params params) { law_.emplace(std::move(params)); }

  double duty() const { return duty_; }  // positive in the servo's direction

 private:
  enum Mode { current = 0, velocity = 1, position = 3, turns = 4, current_position = 5, pwm = 16 };
  static double sign(const RegisterFile& registers);
  static int offset(const RegisterFile& registers);
  double raw(const RegisterFile& registers) const;
  int place(const RegisterFile& registers) const;
  void wrap(const RegisterFile& registers);
  void hold_law(const RegisterFile& registers);
  void hold(RegisterFile& registers);
  double position_loop(const RegisterFile& registers, double goal, double step_s);
  double law_loop(const RegisterFile& registers, double goal, double step_s);
  double velocity_loop(const RegisterFile& registers, double step_s);
  void report(RegisterFile& registers) const;

  ServoReading reading_;
  double origin_ = 0;  // position from which turns are counted
  Trajectory trajectory_;
  // Speed and acceleration of the present profile; speed 0: no profile.
  double profile_speed_ = 0, profile_rate_ = 0;
  // Shape of the present profile, encoded as in the register moving_status.
  int shape_ = 0;
  double integral_ = 0;  // integral term, in units of PWM
  double pwm_ = 0, duty_ = 0;
  bool powered_ = false;
  std::optional<IdentifiedLaw> law_;
};

}  // namespace kaz::sim
