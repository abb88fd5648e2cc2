// Gait generator for walking and turning: poses of trunk and feet at each phase, and the leg angles.
// SPDX-License-Identifier: Apache-2.0
//
// Pure functions. Units: m, s, rad. Frame: x forward, y left, z up. Phase 0..1 is one cycle of two steps:
// the left foot supports in (0, 0.5), the right one in (0.5, 1).
//
// The ankles have no roll joint. So a sole is flat on the floor only if hip roll and trunk roll add up to
// zero. The robot shifts its weight sideways by rolling the trunk about the hips; the legs stay vertical. The
// legs have no yaw joint either. The robot turns by sliding its two soles in opposite directions during
// double support.
//
// Zero moment point criterion: c(t) is the planned sideways distance of the center of mass from the middle of
// the feet. This distance is a sine: c(t) = C sin(2 pi phase). The height of the center of mass is h. The
// cart-table model (Kajita and others, 2003, equation 3) concentrates the whole mass at the center of mass.
// In this model, the zero moment point (ZMP) is p = c - (h/g) c''. Since c(t) is a sine, the ZMP p(t) is also
// a sine:
//   p(t) = C (1 + h w^2 / g) sin(2 pi phase),   w = 2 pi / period.
//
// A foot may be lifted only while p lies inside the sole of the other foot. The distance of p from the inner
// edge of this sole must be at least `margin`. `swing` is the duration of a foot's swing, divided by the
// duration of the cycle. In the middle of a swing, |p(t)| has its maximum. So the phase at the beginning and
// at the end of a swing satisfies this equation:
//   |sin(2 pi phase)| = cos(pi swing).
// The distance of the inner edges of the soles from the middle of the feet is hip_y cos(roll) - kHalfSole.
// These conditions determine the amplitude of the trunk's roll, which roll_for() computes.
#pragma once

#include "host/motion/inverse.h"
#include "shared/base/angle.hpp"

namespace kaz::motion {

// Edges of the sole relative to the ankle's axis, m. The values are from the collision box in kaz.urdf.
inline constexpr double kToe = 0.060, kHeel = -0.040, kHalfSole = 0.030;

// Pose of the trunk. The origin is on the floor below the midpoint of the ankles.
struct Stance {
  double x = 0, z = 0.145;
  double pitch = 3 * kDegree;  // rad; positive: leans forward
  // Roll, rad; positive to the right. The trunk first rotates by `pitch`, then rolls about its forward axis.
  double roll = 0;
};

// Returns the joint angles of the crouch, arms included, in which every gait starts and ends.
JointAngles home();

// Positions of the feet, m. `*_forward`: distance ahead of the midpoint. `*_lift`: height above the floor.
struct Feet {
  double left_forward = 0, left_lift = 0, right_forward = 0, right_lift = 0;
};
// Sets the leg angles so that both soles are parallel to the floor. If the wanted position of an ankle is out
// of reach, the leg is extended from the hip toward that position. If a joint of a leg would exceed a limit,
// the angles of that leg stay unchanged.
void place_legs(JointAngles& angles, const Stance& stance, const Feet& feet);

// Returns the center of mass for this stance, relative to the midpoint of the ankles, m.
Eigen::Vector3d centre_over_feet(const Stance& stance);

// Parameters of a gait.
struct Shape {
  double period = 1.0;    // s
  double margin = 0.011;  // m, margin of the ZMP criterion above
  double swing = 0.30;    // duration of each foot's swing, as a share of the cycle
  double lift = 0.010;    // m, height to which a swinging foot is lifted
  // Delay of the feet relative to the trunk, as a share of the cycle. The delay compensates for the lag of
  // the servos.
  double lag = 0.02;
  // Upper limit of the roll. The feet would touch each other at a roll of 24.6 degrees.
  double max_roll = 22 * kDegree;
};
// Returns the amplitude of the trunk's roll that satisfies the ZMP criterion, at most max_roll.
double roll_for(const Shape& shape);
// zmp_amplitude() returns the amplitude of the ZMP for this roll (m). inner_edge() returns the lateral
// position of the soles' inner edge (m).
double zmp_amplitude(const Shape& shape, double roll);
double inner_edge(double roll);

// Step parameters of a cycle.
struct Steps {
  double amplitude = 0;        // 0: standing; 1: full steps
  double left = 0, right = 0;  // m, length of each foot's stride relative to the hips
  // Sliding amplitude of each foot, m; positive if the robot turns to the left.
  double reach = 0;
  double lean = 0;    // rad, added to the trunk's pitch (Stance::pitch); positive forward
  double roll = 0;    // rad, added to the gait's roll of the trunk; positive to the right
  double lift = 1;    // factor on the height to which a swinging foot is lifted
  double height = 0;  // m, added to the height of the hips (Stance::z)
};
// Returns the joint angles at a phase. The arms have the angles of home(). `roll`: amplitude of the trunk's
// roll, from roll_for().
JointAngles legs_at(const Shape& shape, double roll, double phase, const Steps& steps);

// Returns the planned roll of the trunk at a phase.
double roll_at(double roll, double phase, double amplitude);
// Returns the planned share of the weight on the left foot, which is 1 while the right foot swings.
double left_share(const Shape& shape, double phase, double amplitude);

}  // namespace kaz::motion
