// Locked-rotor test: torque, voltage and current of a motor whose output shaft is held by a lever.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/body/description/motor_file.h"

namespace kaz::sim {

struct LockedLever {
  double duty = 1;
  double supply_volts = 10;  // open-circuit voltage of the source
  double supply_ohms = 0;    // resistance between source and driver
  // Duration of the test. The motor starts cold and at rest. The driving flank of the gear is in contact from
  // the start.
  double seconds = 0.05;
  // True: the drive is switched off 100 ms before the end of the test, and on again 50 ms later. Reason:
  // while a motor heats up, its torque falls. Without the pause, static friction would hold the rotor. Then
  // the lever would measure the higher torque of the cold motor until the end of the test. The pause releases
  // the rotor. After the pause, the lever measures the torque that the warm motor can apply.
  bool anew = false;
};

struct LeverReading {
  double torque_nm = 0;
  double terminal_volts = 0;  // voltage at the driver, under load
  double supply_amperes = 0;
  double winding_celsius = 0;
};

// Runs the test in steps of 1 ms, like a simulation of the robot. Returns the readings at the end of the
// test.
LeverReading measure_locked_lever(const MotorParams& motor, const LockedLever& bench);

}  // namespace kaz::sim
