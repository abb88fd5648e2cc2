// All links of Kaz: where they are, and where the weight is, from joint angles.
// SPDX-License-Identifier: Apache-2.0
//
// Numbers of shared/robot/kaz/kaz.urdf; a test holds every one against it. Frames as there: parallel
// to the trunk's (x forward, y left, z up) at the zero posture, origin on the link's own joint. The
// trunk's origin lies midway between the hips. Metres, kilograms, radians.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include "host/robot/kinematics.h"

namespace kaz::motion {

using host::JointAngles;
using host::Side;

struct Link {
  int parent;              // joint number of the link that carries it; -1: the trunk
  Eigen::Vector3d origin;  // of its joint, in the parent's frame
  Eigen::Vector3d axis;
  double mass;
  Eigen::Vector3d centre;  // of its mass, in its own frame
};
// The link that each joint moves, by joint number.
const std::array<Link, KZ_JOINTS>& links();
inline constexpr double kTrunkMass = 0.550;
inline constexpr double kTotalMass = 1.600;

// Pose of each joint's link in the trunk's frame.
using Poses = std::array<Eigen::Isometry3d, KZ_JOINTS>;
Poses forward(const JointAngles& angles);

// Of the whole robot, in the trunk's frame.
Eigen::Vector3d centre_of_mass(const JointAngles& angles);

// Limbs as capsules around the line from `from` to `to`, trunk frame, m: upper arms, forearms,
// hands, thighs, shanks, feet. For what sees the robot itself; every collision shape of their links in the
// URDF is inside (a test).
struct Limb {
  Eigen::Vector3d from, to;
  double radius_m = 0;
};
std::array<Limb, 12> limbs(const JointAngles& angles);

// Middle of what the jaws enclose, in the frame of the link `l_elbow` or `r_elbow`: kaz-model's.
inline const Eigen::Vector3d kGrasp(0, 0, -0.093);
// Pose of the hand in the trunk's frame: origin at the grasp's middle, axes of the forearm.
Eigen::Isometry3d trunk_from_grasp(const JointAngles& angles, Side hand);

}  // namespace kaz::motion
