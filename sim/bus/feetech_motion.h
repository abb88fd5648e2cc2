// Motion control of a virtual Feetech servo: computes the motor's duty from registers and position sensor.
// SPDX-License-Identifier: Apache-2.0
//
// Positions are in steps of the position sensor, speeds in steps/s. The duty is -1..1. All these values are
// positive in the servo's direction.
//
// The maker documents modes, units, limits, and the update period of 1 ms. Rhoban (a robotics team) measured
// the duty of an STS3215. The duty is the product of 0.166, the P gain, and the position error in rad. The
// magnitude of the duty is limited to 0.97. docs/reference/servo-bus.md names the sources.
//
// An identified servo has its own law in modes 0 and 3: command delay, slew limit, duty and lag
// (identified_law.h). A profile in the registers acts on top of it.
//
// We chose the scales of the D gain, the I gain and the speed loop, and the shape of the profile near the
// goal. We also chose the behavior after the torque is switched on: the servo holds the present position
// until a goal is written.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "sim/body/motor/motor_drive.h"
#include "sim/bus/identified_law.h"
#include "sim/bus/register_file.h"
#include "sim/bus/servo_reading.h"
#include "sim/bus/trajectory.h"

namespace kaz::sim {

class FeetechMotion {
 public:
  // Duty per rad and unit of P of an identified STS3215, measured by an oscilloscope (kscalelabs/sysid).
  static constexpr double kLoggedDutyPerRad = 0.1649;

  // Advances by one step, nominally 1 ms, and updates the registers that describe the motion. `limit` is the
  // maximum duty that the protection allows, 0..1.
  MotorDrive step(RegisterFile& registers, const ServoReading& reading, double limit,
                  double step_s);

  void power_on(const ServoReading& reading);
  // Call after a host has written goal_position.
  void goal_written(const RegisterFile& registers);
  // Returns the register that contains the goal of the present mode.
  std::string_view goal_register(const RegisterFile& registers) const;
  // Makes `position` the present position by setting the register position_offset. The offset is kept without
  // power, also if EEPROM is locked.
  void set_position(RegisterFile& registers, int position);
  // Sets the number of turns counted since power-on to 0.
  void reset_turns(const servo_bus::Model& model);

  void use_law(IdentifiedLaw::Params params) { law_.emplace(std::move(params)); }

  double duty() const { return duty_; }

 private:
  enum class Mode { position, speed, duty, steps };
  Mode mode_of(const RegisterFile& registers) const;
  // Returns the unit of goal_speed and present_speed, steps/s.
  static double speed_unit(const RegisterFile& registers);
  int position(const RegisterFile& registers) const;
  double goal(const RegisterFile& registers) const;
  void hold(const RegisterFile& registers, double position);
  void follow_profile(const RegisterFile& registers, double goal, double step_s);
  double position_loop(const RegisterFile& registers, const ServoReading& reading, double position,
                       double most, double step_s);
  double speed_loop(const RegisterFile& registers, double speed, double step_s);
  void report(RegisterFile& registers, const ServoReading& reading, int position) const;

  double steps_ = 0;         // last reading of the position sensor
  double turns_origin_ = 0;  // sensor position from which multi-turn positions count
  Trajectory trajectory_;
  double target_ = 0;       // setpoint of the control loop
  bool moving_ = false;     // the setpoint moves
  double steps_goal_ = 0;   // goal of mode 3
  double timed_speed_ = 0;  // speed computed from goal_time; 0: goal_time is not used
  double integral_ = 0;
  std::array<double, 256> errors_{};  // position errors (rad) in the last 256 steps, for the D term
  std::uint8_t newest_ = 0;
  double duty_ = 0;
  bool powered_ = false;
  bool torque_written_ = false;  // the register torque_enable was 1 in the last step
  std::optional<IdentifiedLaw> law_;
  bool goal_known_ = false;  // true if a goal was written since the torque was last switched off
};

}  // namespace kaz::sim
