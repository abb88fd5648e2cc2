// Protection of a virtual DYNAMIXEL: voltage, temperature, overload.
// SPDX-License-Identifier: Apache-2.0
//
// The maker documents two rules. The register hardware_error_status shows the present errors. An error that
// is selected in the register `shutdown` switches the torque off until a reboot. The maker does not publish
// the following details. We chose them:
// - A supply voltage outside the limits is an error after 100 ms.
// - An overload is a torque that exceeds 80 % of the maximum torque for more than 2 s. The maximum torque
//   depends on the present supply voltage.
// - An error that is not selected in `shutdown` ends when the cause of the error ends.
//
// The torque is not measured. The model computes the torque as a fraction of the maximum torque. If
// the motor turns in the direction of the duty, this fraction is: |duty| - |speed| / no-load speed. If the
// motor turns against the direction of the duty, this fraction is |duty|. Encoder errors and electrical
// shocks are not simulated.
#pragma once

#include "sim/bus/register_file.h"
#include "sim/bus/servo_reading.h"

namespace kaz::sim {

class DynamixelProtection {
 public:
  // Advances by one step in which the motor has the duty `duty`. Sets hardware_error_status, torque_enable,
  // and the registers of voltage, temperature, load and current.
  void step(RegisterFile& registers, const ServoReading& reading, double duty, double step_s);
  void power_on() { *this = {}; }
  // Returns true if an error has switched the torque off. The torque can be switched on again only after a
  // reboot.
  bool shut_down() const { return latched_ != 0; }

 private:
  // `bad_voltage_s_` counts the seconds while the supply voltage is outside the limits. `overload_s_` counts
  // the seconds while the torque is above 80 % of the maximum torque. When the condition of a counter ends,
  // the counter becomes 0.
  double bad_voltage_s_ = 0, overload_s_ = 0;
  int latched_ = 0;  // bits of hardware_error_status
};

}  // namespace kaz::sim
