// Joint calibration of a virtual robot, and its error by ground truth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/board/sensor_file.h"
#include "tools/lockstep/calibrated_joints.h"

namespace kaz::studies {

using lockstep::calibrate_joints, lockstep::CalibratedJoints, lockstep::JointLines;

// Errors of a line, rad, at `count` angles from the joint's lower limit to the upper one: what the board
// reports without noise, less the truth.
std::vector<double> true_errors(const sim::SensorParams& params, sim::SensorSet sensors,
                                std::uint64_t seed, int joint, const host::JointCalibration& line,
                                int count);

}  // namespace kaz::studies
