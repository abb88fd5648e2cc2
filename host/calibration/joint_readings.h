// Readings for the calibration of joints: moves the robot to stops and postures, and averages codes.
// SPDX-License-Identifier: Apache-2.0
//
// The board reports angles in terms of its calibration in use. Codes are recovered from them
// (docs/reference/protocol.md).
//
// Stops lie outside the joint limits, and a board does not drive a joint beyond its limits. So the
// calibration in RAM is replaced by a calibration with 0.85 of the nominal scale, with which every stop seems
// to be well inside the limits. With low gains and a target 6 degrees beyond the stop, a joint presses with a
// third of its torque. The caller ensures free space: only the stop may end a joint's motion.
//
// The caller restores gains, limits and calibration.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/calibration/joint_estimator.h"
#include "host/calibration/joint_motions.h"
#include "host/robot/robot.h"

namespace kaz::calibration {

// Reading of one joint at one stop.
struct StopReading {
  int joint = 0;
  Stop stop = Stop::lower;
  double code = 0;    // mean code
  double spread = 0;  // standard deviation of the codes
  std::string fault;  // reason why the reading is not valid, one sentence; empty: valid
};

// Mean codes of all joints and mean specific force in one posture.
struct FloorReading {
  std::array<double, KZ_JOINTS> codes{};  // mean codes
  bool has_force = false;                 // false: the board has no accelerometer
  double forward_m_per_s2 = 0, left_m_per_s2 = 0;
  double time_s = 0;  // since the start of read_floor()
};

// Progress callback: the completed share of the work (0 to 1), and the current step. Must not be empty.
using OnReading = std::function<void(double share, const std::string& what)>;

// Switches all motors off and sets the calibration for stops in RAM.
Result<void> prepare_for_stops(host::Robot& robot);
// Runs the group on a suspended robot, after prepare_for_stops(). Appends to `readings` after each press, so
// readings from before a failure are kept. On success, the motors are off. Errors: link lost, board reset,
// motors switched off by the board, interrupted.
Result<void> read_stops(host::Robot& robot, const MotionGroup& group, const OnReading& on,
                        std::vector<StopReading>& readings);

// Switches all motors off and sets `lines` as the calibration in RAM.
Result<void> use_lines(host::Robot& robot,
                       const std::array<host::JointCalibration, KZ_JOINTS>& lines);
// Moves the robot through floor_stances(), from any stance on the floor. `lines` must be in use. Ends with
// straight legs, on which the robot stands without power, and motors off.
Result<void> read_floor(host::Robot& robot,
                        const std::array<host::JointCalibration, KZ_JOINTS>& lines,
                        const OnReading& on, std::vector<FloorReading>& readings);

// Reads the mean codes of all joints at rest, with the motors off or holding. `lines` must be in use.
Result<FloorReading> read_here(host::Robot& robot,
                               const std::array<host::JointCalibration, KZ_JOINTS>& lines);

// ---- Equations

// Standard deviation of the angle at a stop, rad. Stops are milled to 0.1 degrees and yield by less.
inline constexpr double kStopSigma = 0.1 * kDegree;
// Standard deviation of the angle of a stored line at a stop, rad. This is larger than kStopSigma, because
// floor readings or a gauge may have moved the line away from the stop's true angle.
inline constexpr double kStoredSigma = 0.2 * kDegree;

// Adds the readings without fault.
void add_stops(JointEstimator& to, const std::vector<StopReading>& readings);
// Adds both stops of a joint as read through a stored calibration, which passes near them.
void add_stops(JointEstimator& to, int joint, const host::JointCalibration& line);

// Returns the prior standard deviations (g) of the additional unknowns of add_floor(), in pairs for each
// reading: forward and left. Each unknown is the change of the accelerometer's zero since the reading
// before; at the first reading, since 0.
std::vector<double> floor_unknowns(const std::vector<FloorReading>& readings);
// Adds the closure of the legs: both soles lie on one plane. With has_force, its normal is also the
// direction of the specific force. `to` must have floor_unknowns() as additional unknowns. `about`:
// solution at which the equations are linearized.
void add_floor(JointEstimator& to, const std::vector<FloorReading>& readings,
               const JointEstimator::Solution& about);

}  // namespace kaz::calibration
