// Two-link inverse kinematics of leg and arm.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/inverse.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kaz::motion {

namespace {

using namespace host;
using Eigen::Vector3d;

constexpr double kUpperArm = 0.070;

struct Limbs {
  int hip_roll, sh_pitch;  // first joint of each chain; the others have consecutive numbers
};
constexpr Limbs limbs(Side side) {
  return side == Side::left ? Limbs{l_hip_roll, l_sh_pitch} : Limbs{r_hip_roll, r_sh_pitch};
}

bool inside(int joint, double angle) {
  // Tolerance for rounding: the limit itself is allowed.
  constexpr double kRounding = 1e-9;
  const JointInfo& info = joint_table()[static_cast<std::size_t>(joint)];
  return angle >= info.lower_rad - kRounding && angle <= info.upper_rad + kRounding;
}

double wrapped(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

}  // namespace

std::optional<LegAngles> leg_to(Side side, const Vector3d& ankle, double foot_pitch) {
  static_assert(kLeg.thigh == kLeg.shank);
  constexpr double kBone = kLeg.thigh;
  // Vector from hip to ankle, trunk frame, m; after hip roll the leg is planar with length `length`.
  const Vector3d leg_vector = ankle - Vector3d(0, side == Side::left ? kLeg.hip_y : -kLeg.hip_y, 0);
  const double down = std::hypot(leg_vector.y(), leg_vector.z());
  const double length = std::hypot(leg_vector.x(), down);
  if (length > 2 * kBone || length < 1e-3 || leg_vector.z() > 0) return std::nullopt;
  LegAngles leg;
  leg.hip_roll = std::atan2(leg_vector.y(), -leg_vector.z());
  // Isosceles triangle of thigh and shank: length = 2 bone cos(knee / 2).
  leg.knee = 2 * std::acos(length / (2 * kBone));
  // The thigh is half the knee's angle ahead of the line from hip to ankle.
  leg.hip_pitch = std::atan2(-leg_vector.x(), down) - leg.knee / 2;
  leg.ankle_pitch = foot_pitch - leg.hip_pitch - leg.knee;
  const int first = limbs(side).hip_roll;
  if (!inside(first, leg.hip_roll) || !inside(first + 1, leg.hip_pitch) ||
      !inside(first + 2, leg.knee) || !inside(first + 3, leg.ankle_pitch)) {
    return std::nullopt;
  }
  return leg;
}

LegAngles leg_of(const JointAngles& angles, Side side) {
  const double* const in = angles.data() + limbs(side).hip_roll;
  return {in[0], in[1], in[2], in[3]};
}

void set_leg(JointAngles& angles, Side side, const LegAngles& leg) {
  double* const out = angles.data() + limbs(side).hip_roll;
  out[0] = leg.hip_roll;
  out[1] = leg.hip_pitch;
  out[2] = leg.knee;
  out[3] = leg.ankle_pitch;
}

// With the shoulder at zero the grasp is at q = (-b sin e, 0, -a - b cos e), elbow e. Roll r rotates it to
// (q.x, -q.z sin r, q.z cos r), and pitch does not change y. Hence e from the distance, r from y, and the
// pitch as the difference of the directions in the x-z plane.
std::optional<ArmAngles> arm_to(Side side, const Vector3d& grasp) {
  const int first = limbs(side).sh_pitch;
  const double b = -kGrasp.z();
  // Vector from shoulder to grasp, trunk frame, m. Law of cosines: |v|^2 = a^2 + b^2 + 2 a b cos e with the
  // upper arm a and the forearm b to the grasp.
  const Vector3d arm_vector = grasp - links()[static_cast<std::size_t>(first)].origin;
  const double cosine =
      (arm_vector.squaredNorm() - kUpperArm * kUpperArm - b * b) / (2 * kUpperArm * b);
  if (std::abs(cosine) > 1) return std::nullopt;
  ArmAngles arm;
  arm.elbow = -std::acos(cosine);
  const double x = -b * std::sin(arm.elbow), z = -kUpperArm - b * cosine;
  if (std::abs(arm_vector.y()) > std::abs(z)) return std::nullopt;
  arm.sh_roll = std::asin(-arm_vector.y() / z);
  arm.sh_pitch = wrapped(std::atan2(arm_vector.x(), arm_vector.z()) -
                         std::atan2(x, z * std::cos(arm.sh_roll)));
  if (!inside(first, arm.sh_pitch) || !inside(first + 1, arm.sh_roll) ||
      !inside(first + 2, arm.elbow)) {
    return std::nullopt;
  }
  return arm;
}

ArmAngles arm_of(const JointAngles& angles, Side side) {
  const double* const in = angles.data() + limbs(side).sh_pitch;
  return {in[0], in[1], in[2]};
}

void set_arm(JointAngles& angles, Side side, const ArmAngles& arm) {
  double* const out = angles.data() + limbs(side).sh_pitch;
  out[0] = arm.sh_pitch;
  out[1] = arm.sh_roll;
  out[2] = arm.elbow;
}

JointAngles within_limits(JointAngles angles) {
  for (std::size_t j = 0; j < angles.size(); ++j)
    angles[j] = std::clamp(angles[j], joint_table()[j].lower_rad, joint_table()[j].upper_rad);
  return angles;
}

}  // namespace kaz::motion
