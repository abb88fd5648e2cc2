// Protection of a virtual servo of Feetech's: overload, overcurrent, voltage, temperature.
// SPDX-License-Identifier: Apache-2.0
//
// Data sheet STS3215 (2020-04-10) and memory tables: a torque above overload_torque for protection_time
// limits the output to protective_torque, a current above protection_current for overcurrent_time switches it
// off, until a new position command; a voltage outside of its limits counts while it lasts; above
// max_temperature the torque goes off. unload_condition says which of these act; the register `status` has
// all of them.
//
// "Torque" is taken as the duty less the share that speed takes of it: a servo that runs freely at full speed
// has none, a stalled one its duty. How a hot servo recovers is not documented: here the host switches the
// torque on again.
#pragma once

#include "sim/bus/feetech_motion.h"
#include "sim/bus/register_file.h"

namespace kaz::sim {

class FeetechProtection {
 public:
  // One step, after FeetechMotion::step() computed `duty`. Sets `status`, `present_voltage` and the like.
  void step(RegisterFile& registers, const ServoReading& reading, double duty, double step_s);
  // Highest duty for the coming step, 0..1.
  double limit(const RegisterFile& registers) const;
  // A new position command releases overload and overcurrent.
  void goal_written() { overload_s_ = overcurrent_s_ = 0, overloaded_ = overcurrent_ = false; }
  void power_on() { *this = {}; }

 private:
  double overload_s_ = 0, overcurrent_s_ = 0;  // how long so far
  bool overloaded_ = false, overcurrent_ = false, bad_voltage_ = false;
};

}  // namespace kaz::sim
