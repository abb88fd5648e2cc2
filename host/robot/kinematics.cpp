// Forward kinematics of head and legs, and the closed form that points the left eye.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/kinematics.h"

#include <algorithm>
#include <cmath>

namespace kaz::host {

namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

// Joint origins in the parent's frame: shared/robot/kaz/kaz.urdf.
const Vector3d kNeckPan(0, 0, 0.118), kNeckTilt(0, 0, 0.018);
constexpr double kEyeX = 0.030, kEyeY = 0.020, kEyeZ = 0.022;  // right eye: y negative

// Optical axes (x right, y down, z forward) in a frame with x forward, y left, z up.
Eigen::Matrix3d optical_axes() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return axes;
}

Isometry3d turn(const Vector3d& origin, double angle, const Vector3d& axis) {
  return Translation3d(origin) * AngleAxisd(angle, axis);
}

}  // namespace

Isometry3d trunk_from_eye(const JointAngles& angle, Side eye) {
  Isometry3d head_from_eye = Isometry3d::Identity();
  head_from_eye.linear() = optical_axes();
  head_from_eye.translation() = Vector3d(kEyeX, eye == Side::left ? kEyeY : -kEyeY, kEyeZ);
  return turn(kNeckPan, angle[neck_pan], Vector3d::UnitZ()) *
         turn(kNeckTilt, angle[neck_tilt], Vector3d::UnitY()) * head_from_eye;
}

Isometry3d trunk_from_sole(const JointAngles& angle, Side foot) {
  const bool left = foot == Side::left;
  return turn({0, left ? kLeg.hip_y : -kLeg.hip_y, 0}, angle[left ? l_hip_roll : r_hip_roll],
              Vector3d::UnitX()) *
         turn(Vector3d::Zero(), angle[left ? l_hip_pitch : r_hip_pitch], Vector3d::UnitY()) *
         turn({0, 0, -kLeg.thigh}, angle[left ? l_knee : r_knee], Vector3d::UnitY()) *
         turn({0, 0, -kLeg.shank}, angle[left ? l_ankle_pitch : r_ankle_pitch], Vector3d::UnitY()) *
         Translation3d(0, 0, -kLeg.ankle_height);
}

Side supporting_foot(const JointAngles& angle) {
  constexpr double kSame = 1e-3;
  const double left = trunk_from_sole(angle, Side::left).translation().z();
  const double right = trunk_from_sole(angle, Side::right).translation().z();
  return right < left - kSame ? Side::right : Side::left;
}

Isometry3d foot_from_eye(const JointAngles& angle) {
  return trunk_from_sole(angle, supporting_foot(angle)).inverse() * trunk_from_eye(angle);
}

Gaze gaze_of(const JointAngles& angle) {
  return {angle[neck_pan], angle[neck_tilt]};
}

// With q the point from the neck, the eye's axis passes through it when, in the frame of the head,
// its y is the eye's y (gives pan) and its z the eye's z (gives tilt).
Gaze gaze_at(const Vector3d& point) {
  constexpr double kNearest = 0.05;
  const Vector3d q = point - kNeckPan;
  const double horizontal = std::max(std::hypot(q.x(), q.y()), kNearest);
  const double pan = std::atan2(q.y(), q.x()) - std::asin(kEyeY / horizontal);

  const double forward = std::sqrt(horizontal * horizontal - kEyeY * kEyeY);
  const double up = q.z() - kNeckTilt.z();
  const double tilt = std::asin(kEyeZ / std::hypot(forward, up)) - std::atan2(up, forward);
  return {pan, tilt};
}

Gaze within_limits(const Gaze& gaze, double margin_rad) {
  const auto inside = [&](double angle, Joint joint) {
    const JointInfo& info = joint_table()[static_cast<std::size_t>(joint)];
    return std::clamp(angle, info.lower_rad + margin_rad, info.upper_rad - margin_rad);
  };
  return {inside(gaze.pan_rad, neck_pan), inside(gaze.tilt_rad, neck_tilt)};
}

}  // namespace kaz::host
