// A known gait of Kaz as a test program: walking and turning by slip, as joint angles over phase.
// SPDX-License-Identifier: Apache-2.0
//
// It was found on another simulator of the same body, and is the load by which solvers are compared; no
// behaviour of the product uses it. Pure functions. Units m and rad; x forward, y left, z up. Phase 0..1
// counts cycles: the left foot carries in (0, 0.5), the right one in (0.5, 1).
//
// The trunk leans sideways about the hips, which moves the weight over one foot: a foot stays flat where
// hip roll is the trunk's roll turned round. No joint turns about the vertical: the robot turns by
// moving its soles against each other while both carry.
#pragma once

#include "host/robot/kinematics.h"
#include "host/robot/posture.h"

namespace kaz::gait {

using host::JointAngles;

constexpr double kDegree = 3.14159265358979323846 / 180;

// Where the middle of the hips is, seen from the middle of the ankles on the floor below it.
struct Body {
  double x = 0, z = 0.145;
  double pitch = 3 * kDegree;  // of the trunk, + forward
  double roll = 0;             // + to the right, about the axis that pitch has turned
};

struct Leg {
  double hip_roll = 0, hip_pitch = 0, knee = 0, ankle_pitch = 0;
};

// With the sole flat: `forward` of the ankle from the ankles' middle, `lift` of the sole. A place out of
// reach gives the straight leg that points there.
Leg leg_to(const Body& body, host::Side side, double forward, double lift);
void set_leg(JointAngles& angles, host::Side side, const Leg& leg);

struct Shape {
  double period = 1.0;         // s
  double roll = 20 * kDegree;  // of the trunk to each side
  double lift = 0.010;         // m
  double swing = 0.30;         // of the cycle, each foot
  double lag = 0.02;           // of the cycle, of the feet behind the trunk
};

// Arms and crouch that the gait starts from and ends in.
JointAngles standing();

struct Stride {
  double left = 0, right = 0;  // m, of each foot against the hips
};
// `amplitude`: 0 stands, 1 walks in full.
JointAngles walking(const Shape& shape, double phase, double amplitude, const Stride& stride);

// `reach`: m, of each foot to and fro against the hips; > 0 turns left, twice a cycle, while both feet
// carry. At phase shape.lag and half a cycle later the feet pass the hips: there it may change.
JointAngles turning(const Shape& shape, double phase, double amplitude, double reach);

}  // namespace kaz::gait
