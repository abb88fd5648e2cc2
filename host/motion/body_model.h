// Body model of Kaz: poses of all links and the center of mass from joint angles.
// SPDX-License-Identifier: Apache-2.0
//
// The numbers are copied from shared/robot/kaz/kaz.urdf; a test compares the copies with that file. The
// frames of the links are the same as in the URDF. At the zero posture, all frames are parallel to the
// trunk's frame (x forward, y left, z up). The origin of a frame is on the link's own joint. The trunk's
// origin lies midway between the hips. Units: m, kg, rad.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include "host/robot/kinematics.h"

namespace kaz::motion {

using host::JointAngles;
using host::Side;

struct Link {
  // Number of the joint that moves the parent link; -1: the parent is the trunk.
  int parent;
  Eigen::Vector3d origin;  // position of the link's joint, in the parent's frame
  Eigen::Vector3d axis;
  double mass;
  Eigen::Vector3d centre;  // center of mass, in the link's frame
};
// Returns all links, indexed by the number of the joint that moves the link.
const std::array<Link, KZ_JOINTS>& links();
inline constexpr double kTrunkMass = 0.550;
inline constexpr double kTotalMass = 1.600;

// Pose of each joint's link in the trunk's frame.
using Poses = std::array<Eigen::Isometry3d, KZ_JOINTS>;
Poses forward(const JointAngles& angles);

// Center of mass of the whole robot, trunk frame.
Eigen::Vector3d centre_of_mass(const JointAngles& angles);

// A limb, modeled as a capsule around the line from `from` to `to`, trunk frame, m. The map uses the capsules
// to ignore pixels that show the robot itself. A test checks that the capsules enclose the collision shapes
// of the limbs in the URDF.
struct Limb {
  Eigen::Vector3d from, to;
  double radius_m = 0;
};
// Returns the capsules of upper arms, forearms, hands, thighs, shanks and feet.
std::array<Limb, 12> limbs(const JointAngles& angles);

// Center of the grasp between the jaws, in the frame of the link `l_elbow` or `r_elbow`, m
// (docs/reference/robot.md).
inline const Eigen::Vector3d kGrasp(0, 0, -0.093);
// Pose of the hand in the trunk frame: origin at the center of the grasp, axes of the forearm.
Eigen::Isometry3d trunk_from_grasp(const JointAngles& angles, Side hand);

}  // namespace kaz::motion
