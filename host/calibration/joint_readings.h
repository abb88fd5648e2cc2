// Readings for the calibration of joints: moves the robot to stops and postures, and averages codes.
// SPDX-License-Identifier: Apache-2.0
//
// The board computes the reported angles from potentiometer codes with the calibration in use. The functions
// below recover the codes from the angles (docs/reference/protocol.md).
//
// Stops lie outside the joint limits, and a board does not drive a joint beyond its limits. So the
// calibration in RAM is replaced by a calibration with 0.85 of the nominal scale. With this calibration, the
// computed angle of every stop is well inside the limits. To press against a stop, a joint gets a target 6
// degrees beyond the stop. The gains are low. So most joints press against their stops with about a third of
// their maximum torque. The joints of the hands press with about a sixth of their maximum torque. The caller
// ensures free space: only the stop may end a joint's motion.
//
// Afterwards, the caller must restore gains, limits and calibration.
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
  double time_s = 0;  // time since the start of read_floor()
};

// Progress callback: the completed share of the work (0 to 1), and the current step. The callback must not be
// empty.
using OnReading = std::function<void(double share, const std::string& what)>;

// Switches all motors off and sets the calibration for stops in RAM.
Result<void> prepare_for_stops(host::Robot& robot);
// Runs the motions of the group on a suspended robot, after prepare_for_stops(). Appends to `readings` after
// each press, so that earlier readings are kept after a failure. On success, the motors are off. Fails if the
// link is lost, the board is reset, the board switches motors off, or the program is interrupted.
Result<void> read_stops(host::Robot& robot, const MotionGroup& group, const OnReading& on,
                        std::vector<StopReading>& readings);

// Switches all motors off and sets `lines` as the calibration in RAM.
Result<void> use_lines(host::Robot& robot,
                       const std::array<host::JointCalibration, KZ_JOINTS>& lines);
// Moves the robot through floor_stances(), from any stance on the floor. `lines` must be the calibration in
// use. At the end, the motors are off, and the robot stands on straight legs, which need no power.
Result<void> read_floor(host::Robot& robot,
                        const std::array<host::JointCalibration, KZ_JOINTS>& lines,
                        const OnReading& on, std::vector<FloorReading>& readings);

// Reads the mean codes of all joints. Precondition: no joint moves; the motors may be off or on. `lines` must
// be the calibration in use.
Result<FloorReading> read_here(host::Robot& robot,
                               const std::array<host::JointCalibration, KZ_JOINTS>& lines);

// ---- Equations

// Standard deviation of the angle at a stop, rad. Stops are milled with a tolerance of 0.1 degrees. Under
// load, they yield by less than 0.1 degrees.
inline constexpr double kStopSigma = 0.1 * kDegree;
// Standard deviation of the angle of a stop, computed with a stored line, rad. Some stored lines were fitted
// not only to the stops, but also to floor readings or to a gauge. With such a line, the computed angle of a
// stop can differ from the true angle. So this value is larger than kStopSigma.
inline constexpr double kStoredSigma = 0.2 * kDegree;

// Adds one equation for each reading without a fault.
void add_stops(JointEstimator& to, const std::vector<StopReading>& readings);
// Adds one equation for each of the joint's two stops, without a reading at the stop. Instead, the stored
// calibration `line` converts the angle of the stop to a potentiometer code. This is possible because a
// stored calibration is nearly correct at the stops.
void add_stops(JointEstimator& to, int joint, const host::JointCalibration& line);

// Returns the prior standard deviations (g) of the additional unknowns of add_floor(). Each reading has two
// of these unknowns: forward and left. For the first reading, the unknown is the zero offset of the
// accelerometer. For each later reading, the unknown is the change of this offset since the previous reading.
std::vector<double> floor_unknowns(const std::vector<FloorReading>& readings);
// Adds equations which state that both soles lie on one plane. If FloorReading::has_force is true, the normal
// of this plane is also the direction of the specific force. Precondition: `to` was constructed with the
// result of floor_unknowns(readings). The parameter `about` is an approximate solution. Each equation is
// linearized at the joint angles that this solution gives for the reading.
void add_floor(JointEstimator& to, const std::vector<FloorReading>& readings,
               const JointEstimator::Solution& about);

}  // namespace kaz::calibration
