// Where trunk and feet are to be at each phase of walking and of turning, and the legs' angles for it.
// SPDX-License-Identifier: Apache-2.0
//
// Pure functions. Metres, seconds, radians; x forward, y left, z up. Phase 0..1 counts cycles: the
// left foot carries in (0, 0.5), the right one in (0.5, 1).
//
// This body has no ankle roll: a sole is flat where hip roll is the trunk's roll turned round, so the
// weight goes sideways by leaning the trunk about the hips, legs upright. No joint turns about the
// vertical either: the robot turns by moving its two soles against each other while both carry.
//
// Criterion: the planned centre of mass moves sideways by c(t) = C sin(2 pi phase) about the middle of
// the feet, at height h above the floor. With the whole weight at its centre (table and cart:
// Kajita et al. 2003, eq. 3) the zero moment point is p = c - (h/g) c'', which for a sine is
//   p(t) = C (1 + h w^2 / g) sin(2 pi phase),   w = 2 pi / period.
// A foot may leave the floor only while p lies inside the other sole, `margin` from its inner edge. A
// swing is centred on the peak and lasts `swing` of the cycle, so it begins and ends where the sine is
// cos(pi swing). The inner edge is hip_y cos(roll) - half the sole's width off the middle. From that
// follows how far the trunk has to lean: roll_for().
#pragma once

#include "host/motion/inverse.h"

namespace kaz::motion {

inline constexpr double kDegree = std::numbers::pi / 180;

// Sole, from kaz.urdf's collision box: from the ankle's axis.
inline constexpr double kToe = 0.060, kHeel = -0.040, kHalfSole = 0.030;

// Where the trunk's origin is, seen from the middle of the ankles on the floor below.
struct Stance {
  double x = 0, z = 0.145;
  double pitch = 3 * kDegree;  // of the trunk, + forward
  double roll = 0;             // + to the right, about the axis that pitch has turned
};

// Arms and crouch that every gait starts from and ends in: docs/robot.md, column home.
JointAngles home();

// Both legs for feet that are flat, each `forward` of the middle and `lift` above the floor: left,
// right. A place out of reach takes the nearest leg that points there.
struct Feet {
  double left_forward = 0, left_lift = 0, right_forward = 0, right_lift = 0;
};
void place_legs(JointAngles& angles, const Stance& stance, const Feet& feet);

// The robot's centre of mass, from the middle of the ankles, with legs placed so.
Eigen::Vector3d centre_over_feet(const Stance& stance);

struct Shape {
  double period = 1.0;    // s
  double margin = 0.011;  // m, criterion above
  double swing = 0.30;    // of the cycle, each foot
  double lift = 0.010;    // m
  double lag = 0.02;      // of the cycle, of the feet behind the trunk: what the servos lag
  double max_roll = 22 * kDegree;  // the feet would touch at 24.6 degrees
};
// Half the width of the trunk's swing that the criterion asks for, at most max_roll.
double roll_for(const Shape& shape);
// The zero moment point's largest deflection, and the inner edge of the soles, for such a swing.
double zmp_amplitude(const Shape& shape, double roll);
double inner_edge(double roll);

// What a foot does in a cycle.
struct Steps {
  double amplitude = 0;        // 0 stands, 1 walks in full
  double left = 0, right = 0;  // m, stride of each foot against the hips
  double reach = 0;            // m, of turning: each foot to and fro, > 0 to the left
  double lean = 0;             // rad, of the trunk forward beyond its pitch
};
JointAngles legs_at(const Shape& shape, double roll, double phase, const Steps& steps);

// Commanded roll of the trunk at a phase.
double roll_at(double roll, double phase, double amplitude);
// Share of the weight that the left foot carries by plan: 1 while the right one swings.
double left_share(const Shape& shape, double phase, double amplitude);

}  // namespace kaz::motion
