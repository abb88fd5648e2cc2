// The motion of a virtual servo of Feetech's: from registers and position sensor to the duty of its motor.
// SPDX-License-Identifier: Apache-2.0
//
// Positions in steps of the sensor, speeds in steps/s, duty -1..1, all in the servo's own direction.
//
// Documented (docs/reference/servo-bus.md names the sources): modes, units, limits, an update each
// millisecond, and duty = 0.166 P e with e in rad, at most 0.97, which Rhoban measured on an STS3215. Not
// documented, hence chosen here: the scales of D, I and of the speed loop, the shape of the profile at its
// end, and that a servo whose torque is switched on holds its position until a goal is written.
#pragma once

#include <array>
#include <cstdint>

#include "sim/body/motor/motor_drive.h"
#include "sim/bus/register_file.h"
#include "sim/bus/servo_reading.h"
#include "sim/bus/trajectory.h"

namespace kaz::sim {

class FeetechMotion {
 public:
  // One millisecond. `limit`: highest duty allowed by the protection, 0..1. Updates the present_* registers
  // of motion.
  MotorDrive step(RegisterFile& registers, const ServoReading& reading, double limit,
                  double step_s);

  void power_on(const ServoReading& reading);
  // A host has written goal_position.
  void goal_written(const RegisterFile& registers);
  // The present position becomes `position`: sets the register position_offset.
  void set_position(RegisterFile& registers, int position);
  // Forgets the turns counted since power-on.
  void reset_turns(const servo_bus::Model& model);

  double duty() const { return duty_; }

 private:
  enum class Mode { position, speed, duty, steps };
  Mode mode_of(const RegisterFile& registers) const;
  int position(const RegisterFile& registers) const;
  double goal(const RegisterFile& registers) const;
  void hold(double position);
  void follow_profile(const RegisterFile& registers, double goal, double step_s);
  double position_loop(const RegisterFile& registers, double position, double step_s);
  double speed_loop(const RegisterFile& registers, double speed, double step_s);
  void report(RegisterFile& registers, const ServoReading& reading, int position) const;

  double steps_ = 0;         // of the sensor
  double turns_origin_ = 0;  // of multi-turn positions
  Trajectory trajectory_;
  double steps_goal_ = 0;   // mode 3
  double timed_speed_ = 0;  // from goal_time; 0: none
  double integral_ = 0;
  std::array<double, 256> errors_{};  // of the last milliseconds, for D
  std::uint8_t newest_ = 0;
  double duty_ = 0;
  bool powered_ = false;
  bool goal_known_ = false;  // written since the torque last went off
};

}  // namespace kaz::sim
