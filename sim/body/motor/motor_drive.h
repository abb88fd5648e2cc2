// Output of a motor driver to its motor during one step.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

struct MotorDrive {
  double duty = 0;       // -1..1, mean over the step; positive accelerates the joint positively
  bool powered = false;  // false: open bridge, only friction and inertia act on the rotor
  // Faults of the gear (docs/reference/simulator.md, "Faults").
  bool jammed = false;   // the joint is locked at its angle
  double slip_nm = 1e3;  // Nm, maximum torque that the gear transmits
};

}  // namespace kaz::sim
