// Gait generator: poses of trunk and feet by phase of walking and turning, and the leg angles for them.
// SPDX-License-Identifier: Apache-2.0
//
// Pure functions. Units: m, s, rad. Frame: x forward, y left, z up. Phase 0..1 is one cycle of two steps:
// the left foot supports in (0, 0.5), the right one in (0.5, 1).
//
// The legs have no ankle roll: a sole is flat if hip roll is minus the trunk's roll, so the weight is shifted
// sideways by rolling the trunk about the hips with the legs vertical. There is no yaw joint either: the
// robot turns by sliding its two soles in opposite directions during double support.
//
// Zero moment point criterion: the planned centre of mass moves sideways by c(t) = C sin(2 pi phase) about
// the middle of the feet, at height h above the floor. With the mass concentrated there (cart-table model:
// Kajita et al. 2003, eq. 3) the zero moment point (ZMP) is p = c - (h/g) c'', which for a sine is
//   p(t) = C (1 + h w^2 / g) sin(2 pi phase),   w = 2 pi / period.
// A foot may leave the floor only while p lies inside the other sole, `margin` from its inner edge. A
// swing is centred on the peak and lasts `swing` of the cycle, so it begins and ends where the sine is
// cos(pi swing). The inner edge is hip_y cos(roll) - half the sole's width off the middle. This
// determines the amplitude of the trunk's roll: roll_for().
#pragma once

#include "host/motion/inverse.h"
#include "shared/base/angle.hpp"

namespace kaz::motion {

// Sole, from kaz.urdf's collision box: from the ankle's axis.
inline constexpr double kToe = 0.060, kHeel = -0.040, kHalfSole = 0.030;

// Pose of the trunk; origin on the floor below the midpoint of the ankles.
struct Stance {
  double x = 0, z = 0.145;
  double pitch = 3 * kDegree;  // of the trunk, + forward
  double roll = 0;             // + to the right, about the axis that pitch has turned
};

// Arms and crouch that every gait starts from and ends in: docs/reference/robot.md, column home.
JointAngles home();

// Sets the leg angles for flat feet, each `forward` of the midpoint and `lift` above the floor (m). A
// position out of reach is replaced by the nearest one on the line from the hip.
struct Feet {
  double left_forward = 0, left_lift = 0, right_forward = 0, right_lift = 0;
};
void place_legs(JointAngles& angles, const Stance& stance, const Feet& feet);

// Centre of mass for this stance, from the midpoint of the ankles.
Eigen::Vector3d centre_over_feet(const Stance& stance);

struct Shape {
  double period = 1.0;    // s
  double margin = 0.011;  // m, criterion above
  double swing = 0.30;    // of the cycle, each foot
  double lift = 0.010;    // m
  double lag = 0.02;      // of the cycle, delay of the feet behind the trunk: the servo lag
  double max_roll = 22 * kDegree;  // the feet would touch at 24.6 degrees
};
// Amplitude of the trunk's roll that satisfies the criterion, at most max_roll.
double roll_for(const Shape& shape);
// Amplitude of the ZMP for this roll (m), and the lateral position of the soles' inner edge (m).
double zmp_amplitude(const Shape& shape, double roll);
double inner_edge(double roll);

// Step parameters of a cycle.
struct Steps {
  double amplitude = 0;        // 0: standing; 1: full steps
  double left = 0, right = 0;  // m, stride of each foot relative to the hips
  double reach = 0;            // m, sliding amplitude of each foot for turning, > 0: to the left
  double lean = 0;             // rad, of the trunk forward beyond its pitch
  double roll = 0;             // rad, of the trunk to the right beyond the gait's
  double lift = 1;             // factor on the height of a swing
  double height = 0;           // m, of the hips beyond the stance's
};
JointAngles legs_at(const Shape& shape, double roll, double phase, const Steps& steps);

// Commanded roll of the trunk at a phase.
double roll_at(double roll, double phase, double amplitude);
// Planned share of the weight on the left foot: 1 while the right one swings.
double left_share(const Shape& shape, double phase, double amplitude);

}  // namespace kaz::motion
