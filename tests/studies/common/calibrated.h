// Joint calibration of a virtual robot, and its true error.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/board/sensor_file.h"
#include "tools/lockstep/calibrated_joints.h"

namespace kaz::studies {

using lockstep::calibrate_joints, lockstep::CalibratedJoints, lockstep::JointLines;

// Returns errors of a calibration, rad, at `count` angles from the joint's lower limit to the upper one.
// Error: angle from the noise-free code, minus true angle. `count`: at least 2.
std::vector<double> true_errors(const sim::SensorParams& params, sim::SensorSet sensors,
                                std::uint64_t seed, int joint, const host::JointCalibration& line,
                                int count);

}  // namespace kaz::studies
