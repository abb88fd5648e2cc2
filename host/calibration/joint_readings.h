// Readings for the calibration of joints: moves the robot to stops and postures, and averages codes.
// SPDX-License-Identifier: Apache-2.0
//
// The board reports angles by the calibration in use; codes are recovered from them (protocol, Calibration).
//
// At the stops. A board does not drive a joint beyond the limits of its angles, and the stops are outside. So
// the calibration in RAM is replaced by one with 0.85 of the nominal scale, under which every stop is well
// inside the limits; with low gains and a target 6 degrees beyond, a joint presses at a third of its torque.
// Nothing but the joint's own stop should end its motion: the caller checks the place.
//
// The caller puts gains, limits and calibration back.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/calibration/joint_estimator.h"
#include "host/calibration/joint_motions.h"
#include "host/robot/robot.h"

namespace kaz::calibration {

struct StopReading {
  int joint = 0;
  Stop stop = Stop::lower;
  double code = 0;    // mean
  double spread = 0;  // standard deviation of the codes
  std::string fault;  // why it is no reading of the stop, one sentence; empty if it is one
};

struct FloorReading {
  std::array<double, KZ_JOINTS> codes{};  // means
  bool has_force = false;                 // the board has an accelerometer
  double forward_m_per_s2 = 0, left_m_per_s2 = 0;
  double time_s = 0;  // since the first reading
};

// Share of the work that is done, and what is done.
using OnReading = std::function<void(double share, const std::string& what)>;

// Motors off for all, the calibration for stops in use.
Result<void> prepare_for_stops(host::Robot& robot);
// Runs the group on a suspended robot; `readings` grows by each press, also if the group then fails. Motors
// are off afterwards. Errors: the link was lost, the board switched the motors off, interrupted.
Result<void> read_stops(host::Robot& robot, const MotionGroup& group, const OnReading& on,
                        std::vector<StopReading>& readings);

// Motors off; `lines` are in use.
Result<void> use_lines(host::Robot& robot,
                       const std::array<host::JointCalibration, KZ_JOINTS>& lines);
// From wherever it stands on the floor through floor_stances(); `lines` must be in use. Ends with straight
// legs, on which it stands without power, and motors off.
Result<void> read_floor(host::Robot& robot,
                        const std::array<host::JointCalibration, KZ_JOINTS>& lines,
                        const OnReading& on, std::vector<FloorReading>& readings);

// Mean codes of all joints at rest, motors off or holding; `lines` are in use.
Result<FloorReading> read_here(host::Robot& robot,
                               const std::array<host::JointCalibration, KZ_JOINTS>& lines);

// ---- Equations

// How well a reading at a stop gives its angle: stops are milled to 0.1 degrees, and yield by less.
inline constexpr double kStopSigma = 0.1 * kDegree;
// The same of a stored line: once the floor or a gauge has corrected it, it is off there.
inline constexpr double kStoredSigma = 0.2 * kDegree;

// Readings without fault.
void add_stops(JointEstimator& to, const std::vector<StopReading>& readings);
// As if both stops had been read, from a stored calibration that passes near them.
void add_stops(JointEstimator& to, int joint, const host::JointCalibration& line);

// Additional unknowns of add_floor(), in g: for each reading how far the accelerometer's zero, forward and to
// the left, has moved since the reading before, at the first one since 0.
std::vector<double> floor_unknowns(const std::vector<FloorReading>& readings);
// Closure of the legs: both soles are flat on one plane, and its normal is where the accelerometer points.
// `about`: where the equations are linearised.
void add_floor(JointEstimator& to, const std::vector<FloorReading>& readings,
               const JointEstimator::Solution& about);

}  // namespace kaz::calibration
