// Protection of a virtual DYNAMIXEL: voltage, temperature, overload.
// SPDX-License-Identifier: Apache-2.0
//
// Documented: hardware_error_status reports them, and the errors that `shutdown` selects switch the torque
// off until a reboot. Chosen, since no numbers are published: a voltage counts after 100 ms outside of its
// limits, an overload is 2 s above 80 % of the torque at that voltage, and an error that is not selected
// lasts as long as its cause. "Torque" is the PWM less the share that the speed takes of it. Not simulated:
// encoder, electrical shock.
#pragma once

#include "sim/bus/register_file.h"
#include "sim/bus/servo_reading.h"

namespace kaz::sim {

class DynamixelProtection {
 public:
  // One step with this duty. Sets hardware_error_status, torque_enable and what is measured of the circuit.
  void step(RegisterFile& registers, const ServoReading& reading, double duty, double step_s);
  void power_on() { *this = {}; }
  // An error has switched the torque off: nothing switches it on but a reboot.
  bool shut_down() const { return latched_ != 0; }

 private:
  double bad_voltage_s_ = 0, overload_s_ = 0;  // how long so far
  int latched_ = 0;                            // of hardware_error_status
};

}  // namespace kaz::sim
