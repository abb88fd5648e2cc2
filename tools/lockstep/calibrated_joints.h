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
  // `stops` is the calibration from the mechanical stops only. `all` is the calibration from the stops and
  // the floor.
  JointLines stops, all;
  // Standard deviation of the error of a joint angle with the calibration `all`. `expected_rad`: root mean
  // square over the joint's range. `worst_rad`: maximum over the joint's range.
  std::array<double, KZ_JOINTS> expected_rad{}, worst_rad{};
  // Each equation of the calibration has a residual and a standard deviation. `worst_residual` is the largest
  // ratio of a residual to the standard deviation of the same equation.
  double worst_residual = 0;
  double seconds = 0;  // simulated duration of the calibration
};

// First, a suspended robot moves its joints to the mechanical stops, and the calibration `stops` is computed.
// Then another robot with the same seed takes readings while standing on the floor, and the calibration `all`
// is computed. The world file of both robots is `options.world_path`. Uses no ground truth. Returns
// Fault::failed if a stop cannot be read. Also returns errors from the robot and the board.
Result<CalibratedJoints> calibrate_joints(const sim::SimulationOptions& options);

// Calls calibrate_joints(), makes a new robot with the same options, and stores the calibration `all` on the
// board of the new robot. Returns the contents of the board's flash in hexadecimal, for
// SimulationOptions::memory.
Result<std::string> calibrated_memory(const sim::SimulationOptions& options);

}  // namespace kaz::lockstep
