// Joint calibration of a virtual robot as `kaz calibrate joints` does it, and the board that stores it.
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
  JointLines stops, all;  // by the stops alone; by stops and floor
  std::array<double, KZ_JOINTS> expected_rad{}, worst_rad{};  // of `all`, one standard deviation
  double worst_residual = 0;
  double seconds = 0;  // of the robot
};

// Suspended, then on the floor of options.world_path. The simulation's truth has no part in it. Errors
// (failed): a stop was not read; the robot's or the board's.
Result<CalibratedJoints> calibrate_joints(const sim::SimulationOptions& options);

// The flash of that robot's board with the calibration stored, in hexadecimal (SimulationOptions::memory).
Result<std::string> calibrated_memory(const sim::SimulationOptions& options);

}  // namespace kaz::lockstep
