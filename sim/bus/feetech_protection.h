// Protection of a virtual Feetech servo: overload, overcurrent, voltage, temperature.
// SPDX-License-Identifier: Apache-2.0
//
// Sources: data sheet STS3215 (2020-04-10) and memory tables.
// - If the torque exceeds overload_torque for longer than protection_time, the output is limited to
//   protective_torque until a new position command.
// - If the current exceeds protection_current for longer than overcurrent_time, the output is off until a new
//   position command.
// - The output is off while the supply voltage is outside the limits.
// - A temperature above max_temperature switches the torque off.
//
// The register unload_condition selects which of these protections act. The register `status` shows the
// conditions of all these protections. The torque is not measured. If the motor turns in the direction of the
// duty, the model computes the torque as: |duty| - |speed| / no-load speed. If the motor turns against the
// direction of the duty, the model computes the torque as |duty|. Thus the torque is 0 if the servo runs
// freely at full speed, and equal to the duty if the servo is stalled. The maker does not document how a hot
// servo recovers. In this simulation, the host must switch the torque on again.
#pragma once

#include "sim/bus/feetech_motion.h"
#include "sim/bus/register_file.h"

namespace kaz::sim {

class FeetechProtection {
 public:
  // Advances by one step. Call after FeetechMotion::step(), which computes `duty`. Sets `status` and the
  // registers of voltage, temperature and current. If the servo is too hot, clears torque_enable.
  void step(RegisterFile& registers, const ServoReading& reading, double duty, double step_s);
  // Returns the maximum duty for the coming step, 0..1.
  double limit(const RegisterFile& registers) const;
  // Call after a new position command, which ends the limitation by overload or overcurrent.
  void goal_written() { overload_s_ = overcurrent_s_ = 0, overloaded_ = overcurrent_ = false; }
  void power_on() { *this = {}; }

 private:
  // `overload_s_` counts the seconds while the torque is above overload_torque. `overcurrent_s_` counts the
  // seconds while the current is above protection_current. When the condition of a counter ends, the counter
  // becomes 0.
  double overload_s_ = 0, overcurrent_s_ = 0;
  bool overloaded_ = false, overcurrent_ = false, bad_voltage_ = false;
};

}  // namespace kaz::sim
