// Output of a motor driver to its motor during one step.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace kaz::sim {

struct MotorDrive {
  double duty = 0;       // mean over the step, -1..1; a positive duty drives the joint forward
  bool powered = false;  // false: the bridge is open, so only friction and inertia act on the rotor
  // Voltage of a supply of this motor alone, V; empty: the supply of the world's other motors.
  std::optional<double> supply_volts = std::nullopt;
  // Faults of the gear (docs/reference/simulator.md, "Faults").
  bool jammed = false;   // true: the gear is jammed and locks the joint at the present angle
  double slip_nm = 1e3;  // maximum torque that the gear transmits, Nm
};

}  // namespace kaz::sim
