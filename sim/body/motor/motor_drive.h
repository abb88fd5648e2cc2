// What a motor driver applies to its motor during one step.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

struct MotorDrive {
  double duty = 0;       // -1..1, mean over the step; positive accelerates the joint positively
  bool powered = false;  // false: the bridge is open, only friction and inertia act on the rotor
  // Faults of the gear (docs/reference/faults.md).
  bool jammed = false;   // the joint is locked at its angle
  double slip_nm = 1e3;  // max torque that the gear transmits between motor and joint, Nm
};

}  // namespace kaz::sim
