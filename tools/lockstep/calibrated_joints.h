// Calibrates the joints of a virtual robot with the procedure of `kaz calibrate joints`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "host/robot/robot_types.h"
#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::lockstep {

using JointLines = std::array<host::JointCalibration, KZ_JOINTS>;

struct CalibratedJoints {
  JointLines stops, all;  // from the stops only; from stops and floor
  // Standard deviation of the angles by `all`: root mean square over the joint's range, and maximum.
  std::array<double, KZ_JOINTS> expected_rad{}, worst_rad{};
  double worst_residual = 0;  // largest residual of an equation, in units of its sigma
  double seconds = 0;         // simulated duration
};

// Calibrates a suspended robot on its stops, then one of the same seed on the floor of options.world_path.
// Uses no ground truth. Returns Fault::failed if a stop cannot be read; else errors of robot and board.
Result<CalibratedJoints> calibrate_joints(const sim::SimulationOptions& options);

// Calibrates the same robot and stores the calibration. Returns its board's flash in hexadecimal, for
// SimulationOptions::memory.
Result<std::string> calibrated_memory(const sim::SimulationOptions& options);

}  // namespace kaz::lockstep
