// A lever on the output shaft, locked, with a scale at its end: what a motor gives at full drive.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/body/description/motor_file.h"

namespace kaz::sim {

struct LockedLever {
  double duty = 1;
  double supply_volts = 10;  // of the source, without load
  double supply_ohms = 0;    // between the source and the driver's terminals
  double seconds = 0.05;     // the motor starts cold, at rest, its backlash taken up
  // The drive is taken off 0.1 s before the end, and put on again 50 ms later. A motor that weakens
  // while it presses is held by its friction; this is what it can lift.
  bool anew = false;
};

struct LeverReading {
  double torque_nm = 0;
  double terminal_volts = 0;  // at the driver, under load
  double supply_amperes = 0;
  double winding_celsius = 0;
};

// What the scale and the meters read at the end. Steps of 1 ms, as the robot's.
LeverReading measure_locked_lever(const MotorParams& motor, const LockedLever& bench);

}  // namespace kaz::sim
