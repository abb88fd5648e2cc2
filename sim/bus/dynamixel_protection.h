// Protection of a virtual DYNAMIXEL: voltage, temperature, overload.
// SPDX-License-Identifier: Apache-2.0
//
// Documented by the maker: hardware_error_status shows these errors. Errors that are selected in `shutdown`
// switch the torque off until a reboot. Chosen by us, because no numbers are published:
// - A voltage outside its limits is an error after 100 ms.
// - An overload is a torque above 80 % of the maximum at that voltage for 2 s.
// - An error that is not selected in `shutdown` lasts as long as its cause.
//
// The torque is computed as the PWM minus the share of PWM that the present speed requires. Encoder errors
// and electrical shocks are not simulated.
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
  double bad_voltage_s_ = 0, overload_s_ = 0;  // duration of the condition so far
  int latched_ = 0;                            // bits of hardware_error_status
};

}  // namespace kaz::sim
