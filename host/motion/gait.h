// Gait generator: poses of trunk and feet by phase of walking and turning, and their leg angles.
// SPDX-License-Identifier: Apache-2.0
//
// Pure functions. Units: m, s, rad. Frame: x forward, y left, z up. Phase 0..1 is one cycle of two steps:
// the left foot supports in (0, 0.5), the right one in (0.5, 1).
//
// The legs have no ankle roll: a sole is flat if hip roll is minus the trunk's roll. So the weight is
// shifted sideways by rolling the trunk about the hips with the legs vertical. There is no yaw joint
// either: the robot turns by sliding its two soles in opposite directions during double support.
//
// Zero moment point criterion: the planned center of mass moves sideways by c(t) = C sin(2 pi phase). This
// is relative to the middle of the feet, at height h above the floor. With the mass concentrated there
// (cart-table model: Kajita et al. 2003, eq. 3), the zero moment point (ZMP) is p = c - (h/g) c''. For a
// sine this is
#pragma once

#include "host/motion/inverse.h"
#include "shared/base/angle.hpp"

namespace kaz::motion {

// Edges of the sole relative to the ankle's axis, m, from the collision box in kaz.urdf.
inline constexpr double kToe = 0.060, kHeel = -0.040, kHalfSole = 0.030;

// Pose of the trunk. Origin: on the floor below the midpoint of the ankles.
struct Stance {
  double x = 0, z = 0.145;
  double pitch = 3 * kDegree;  // + forward
  double roll = 0;             // + to the right, about the axis that is rotated by pitch
};

// Returns the arms and crouch in which every gait starts and ends.
JointAngles home();

// Positions of the feet, m: `forward` of the midpoint, `lift` above the floor.
struct Feet {
  double left_forward = 0, left_lift = 0, right_forward = 0, right_lift = 0;
};
// Sets the leg angles for flat feet. A position out of reach is replaced by the nearest reachable position on
// the line from the hip.
void place_legs(JointAngles& angles, const Stance& stance, const Feet& feet);

// Center of mass for this stance, from the midpoint of the ankles, m.
Eigen::Vector3d centre_over_feet(const Stance& stance);

// Parameters of a gait.
struct Shape {
  double period = 1.0;    // s
  double margin = 0.011;  // m, see the criterion above
  double swing = 0.30;    // share of the cycle for the swing of each foot
  double lift = 0.010;    // m
  // Delay of the feet behind the trunk, as a share of the cycle: the servo lag.
  double lag = 0.02;
  double max_roll = 22 * kDegree;  // the feet touch at 24.6 degrees
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
  double reach = 0;            // m, sliding amplitude of each foot; > 0 turns to the left
  double lean = 0;             // rad, of the trunk, + forward, added to its pitch
  double roll = 0;             // rad, of the trunk, + to the right, added to the gait's
  double lift = 1;             // factor on the height of a swing
  double height = 0;           // m, of the hips, added to the stance's
};
// Returns the joint angles at a phase, arms as in home(). `roll`: amplitude of the trunk's roll, from
// roll_for().
JointAngles legs_at(const Shape& shape, double roll, double phase, const Steps& steps);

// Planned roll of the trunk at a phase.
double roll_at(double roll, double phase, double amplitude);
// Planned share of the weight on the left foot: 1 while the right one swings.
double left_share(const Shape& shape, double phase, double amplitude);

}  // namespace kaz::motion
