// Forward kinematics of eyes and feet, and the head angles that point an eye at a target.
// SPDX-License-Identifier: Apache-2.0
//
// The link frames are defined in shared/robot/kaz/kaz.urdf. The origin of a link's frame is on the link's
// joint. In the zero posture, all link frames are parallel to the trunk's frame (x forward, y left, z up). An
// eye is the optical frame of a camera (vision/image/frame.h). Units: meters and radians.
#pragma once

#include <Eigen/Geometry>

#include "host/robot/posture.h"

namespace kaz::host {

enum class Side { left, right };

// Leg dimensions from the URDF, m: lateral offset of the hip axes, distances between pitch joints, height of
// the ankle above the sole. A test compares the resulting sole poses with the URDF.
struct LegGeometry {
  double hip_y = 0.033, thigh = 0.065, shank = 0.065, ankle_height = 0.030;
};
inline constexpr LegGeometry kLeg;

// Pose of an eye's optical frame in the trunk's frame. The pose agrees with the URDF to 0.01 mm (tested).
Eigen::Isometry3d trunk_from_eye(const JointAngles& angle, Side eye = Side::left);

// Pose of the middle of a sole, below the ankle, in the trunk's frame. The axes are parallel to the axes of
// the foot link.
Eigen::Isometry3d trunk_from_sole(const JointAngles& angle, Side foot);

// Returns the foot that is lower along the trunk's vertical axis. If the heights differ by less than 1 mm,
// returns the left foot.
Side supporting_foot(const JointAngles& angle);

// Pose of the left eye in the foot frame of vision/image/frame.h.
Eigen::Isometry3d foot_from_eye(const JointAngles& angle);

// Head angles.
struct Gaze {
  double pan_rad = 0, tilt_rad = 0;  // a positive pan is to the left, a positive tilt is down
};
Gaze gaze_of(const JointAngles& angle);

// Returns the angles at which `point` (trunk frame, m) lies on the optical axis of the left eye. The returned
// angles can be outside of the joints' ranges. A point less than 5 cm from the pan axis is treated like a
// point at 5 cm.
Gaze gaze_at(const Eigen::Vector3d& point);

// Clamps each angle to its joint's limits, reduced by `margin_rad` at both ends.
Gaze within_limits(const Gaze& gaze, double margin_rad);

}  // namespace kaz::host
