// Where the eyes and feet are, from joint angles; and the head angles that point an eye.
// SPDX-License-Identifier: Apache-2.0
//
// Link frames as in shared/robot/kaz/kaz.urdf: parallel to the trunk's (x forward, y left, z up) at
// the zero posture, origin on the link's own joint. "eye" is the optical frame of a camera
// (vision/image/frame.h). Metres and radians.
#pragma once

#include <Eigen/Geometry>

#include "host/robot/posture.h"

namespace kaz::host {

enum class Side { left, right };

// Of the URDF, m: hip axes off the middle, bones between the pitch joints, ankle above the sole. The
// test that compares the soles' places with the URDF compares these.
struct LegGeometry {
  double hip_y = 0.033, thigh = 0.065, shank = 0.065, ankle_height = 0.030;
};
inline constexpr LegGeometry kLeg;

// Pose of an eye's optical frame in the trunk's frame. Exact to 0.01 mm with the URDF (a test
// compares).
Eigen::Isometry3d trunk_from_eye(const JointAngles& angle, Side eye = Side::left);

// Pose of the middle of a sole, below the ankle, in the trunk's frame; its axes are those of the
// foot link.
Eigen::Isometry3d trunk_from_sole(const JointAngles& angle, Side foot);

// The lower foot along the trunk's vertical axis; the left one if they differ by less than 1 mm.
Side supporting_foot(const JointAngles& angle);

// Pose of the left eye in the foot frame of vision/image/frame.h.
Eigen::Isometry3d foot_from_eye(const JointAngles& angle);

// Head angles.
struct Gaze {
  double pan_rad = 0, tilt_rad = 0;  // positive: to the left, down
};
Gaze gaze_of(const JointAngles& angle);

// Angles at which `point` (trunk frame) lies on the optical axis of the left eye; not limited to
// the range of the joints. Points closer than 5 cm to the neck give the nearest sensible direction.
Gaze gaze_at(const Eigen::Vector3d& point);

// `gaze` with each angle within its joint's limits, `margin_rad` away from them.
Gaze within_limits(const Gaze& gaze, double margin_rad);

}  // namespace kaz::host
