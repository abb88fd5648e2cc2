// Protection of a virtual Feetech servo: overload, overcurrent, voltage, temperature.
// SPDX-License-Identifier: Apache-2.0
//
// Sources: data sheet STS3215 (2020-04-10) and memory tables.
// - A torque above overload_torque for protection_time limits the output to protective_torque until a new
//   position command.
// - A current above protection_current for overcurrent_time switches the output off until a new position
//   command.
// - A voltage outside its limits switches the output off while it lasts.
// - A temperature above max_temperature switches the torque off.
//
// unload_condition selects which of these act. The register `status` shows all of them. The torque is the
// duty minus the share that the present speed requires. It is 0 for a servo that runs freely at full speed,
// and the duty for a stalled one. The recovery of a hot servo is not documented. Here the host must switch
// the torque on again.
#pragma once

#include "sim/bus/feetech_motion.h"
#include "sim/bus/register_file.h"

namespace kaz::sim {

class FeetechProtection {
 public:
  // Advances by one step, after FeetechMotion::step() has computed `duty`. Sets `status`, the registers of
  // voltage, temperature and current, and torque_enable of a hot servo.
  void step(RegisterFile& registers, const ServoReading& reading, double duty, double step_s);
  // Returns the maximum duty for the coming step, 0..1.
  double limit(const RegisterFile& registers) const;
  // A new position command releases overload and overcurrent.
  void goal_written() { overload_s_ = overcurrent_s_ = 0, overloaded_ = overcurrent_ = false; }
  void power_on() { *this = {}; }

 private:
  double overload_s_ = 0, overcurrent_s_ = 0;  // duration so far
  bool overloaded_ = false, overcurrent_ = false, bad_voltage_ = false;
};

}  // namespace kaz::sim
