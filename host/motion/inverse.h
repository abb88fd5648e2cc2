// Closed-form inverse kinematics of legs and arms.
// SPDX-License-Identifier: Apache-2.0
//
// Units: m, rad. Frame: trunk (x forward, y left, z up). There are no yaw joints. A leg has 4 degrees of
// freedom (position of the ankle, pitch of the foot), an arm has 3 (position of the grasp). So the caller
// cannot choose roll and yaw of a foot, and cannot choose the orientation of a hand.
#pragma once

#include <optional>

#include "host/motion/body_model.h"

namespace kaz::motion {

struct LegAngles {
  double hip_roll = 0, hip_pitch = 0, knee = 0, ankle_pitch = 0;
};
// `ankle`: position of the ankle's axis. `foot_pitch`: relative to the trunk; positive if the toes point
// down. The knee bends forward. Returns nothing if the position is out of reach or a joint would exceed its
// limits.
std::optional<LegAngles> leg_to(Side side, const Eigen::Vector3d& ankle, double foot_pitch);
LegAngles leg_of(const JointAngles& angles, Side side);
void set_leg(JointAngles& angles, Side side, const LegAngles& leg);

struct ArmAngles {
  double sh_pitch = 0, sh_roll = 0, elbow = 0;
};
// `grasp`: position of the grasp's center. The elbow bends forward. Returns nothing if the position is out of
// reach, or if a joint would exceed its limits. Also returns nothing if the position is too far to the side
// for the range of the shoulder roll joint.
std::optional<ArmAngles> arm_to(Side side, const Eigen::Vector3d& grasp);
ArmAngles arm_of(const JointAngles& angles, Side side);
void set_arm(JointAngles& angles, Side side, const ArmAngles& arm);

// Returns the angles, each clamped to its joint's limits.
JointAngles within_limits(JointAngles angles);

}  // namespace kaz::motion
