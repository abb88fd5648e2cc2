// Joint angles that bring a foot or a hand to a place, in closed form.
// SPDX-License-Identifier: Apache-2.0
//
// Metres, radians, trunk's frame (x forward, y left, z up). No joint turns about the vertical: a leg
// reaches each place of its ankle with each pitch of its foot, an arm each place of its grasp; what
// else a foot or hand does there follows.
#pragma once

#include <optional>

#include "host/motion/body_model.h"

namespace kaz::motion {

struct LegAngles {
  double hip_roll = 0, hip_pitch = 0, knee = 0, ankle_pitch = 0;
};
// `ankle`: where its axis is to be; `foot_pitch`: of the foot against the trunk, + toes down. The
// knee bends forward. Nothing where the place is out of reach or a joint would leave its range.
std::optional<LegAngles> leg_to(Side side, const Eigen::Vector3d& ankle, double foot_pitch);
LegAngles leg_of(const JointAngles& angles, Side side);
void set_leg(JointAngles& angles, Side side, const LegAngles& leg);

struct ArmAngles {
  double sh_pitch = 0, sh_roll = 0, elbow = 0;
};
// `grasp`: where the middle of the grasp is to be. The elbow bends forward. Nothing where that is out
// of reach, straight above or below the axis of the shoulder's pitch beyond the roll's, or a joint
// would leave its range.
std::optional<ArmAngles> arm_to(Side side, const Eigen::Vector3d& grasp);
ArmAngles arm_of(const JointAngles& angles, Side side);
void set_arm(JointAngles& angles, Side side, const ArmAngles& arm);

// Each angle within its joint's limits.
JointAngles within_limits(JointAngles angles);

}  // namespace kaz::motion
