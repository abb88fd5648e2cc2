// Joint calibration of a virtual robot, and its error by ground truth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/robot/robot_types.h"
#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::studies {

using JointLines = std::array<host::JointCalibration, KZ_JOINTS>;

struct CalibratedJoints {
  JointLines stops, all;  // by the stops alone; by stops and floor
  std::array<double, KZ_JOINTS> expected_rad{}, worst_rad{};  // of `all`, one standard deviation
  double worst_residual = 0;
  double seconds = 0;  // of the robot
};

// As `kaz calibrate joints` does it: suspended, then on the floor of options.world_path. The simulation's
// truth has no part in it. Error (failed): a stop was not read; the robot's or the board's.
Result<CalibratedJoints> calibrate_joints(const sim::SimulationOptions& options);

// Errors of a line, rad, at `count` angles from the joint's lower limit to the upper one: what the board
// reports without noise, less the truth.
std::vector<double> true_errors(const sim::SensorParams& params, sim::SensorSet sensors,
                                std::uint64_t seed, int joint, const host::JointCalibration& line,
                                int count);

}  // namespace kaz::studies
