// Sinusoidal roll of the trunk, cubic trajectories of the feet.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/gait.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kaz::motion {

namespace {

using Eigen::AngleAxisd, Eigen::Vector3d;
using host::kLeg;

constexpr double kGravity = 9.81;
constexpr double kMaxRoll = 24 * kDegree;  // the feet would touch at 24.6 degrees

double fraction(double x) {
  return x - std::floor(x);
}

// Smoothstep: cubic from 0 to 1 with zero slope at both ends.
double eased(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// Progress of a foot's swing, 0..1; >= 1: stance. Swings are centred on phase 0.25 (right) and 0.75 (left).
double into_swing(const Shape& shape, double phase, Side side) {
  const double centre = side == Side::right ? 0.25 : 0.75;
  return fraction(phase - shape.lag - (centre - shape.swing / 2)) / shape.swing;
}

// Height of the foot, m: raised cosine over the swing.
double lift_of(const Shape& shape, double phase, Side side) {
  const double u = into_swing(shape, phase, side);
  return u < 1 ? shape.lift * (1 - std::cos(2 * std::numbers::pi * u)) / 2 : 0;
}

// Forward position of a foot relative to the hips, in strides: -1/2 to 1/2 during swing (eased, a tenth of
// the swing at each end reserved for lift-off and touch-down), linearly back during stance.
double walking_at(const Shape& shape, double phase, Side side) {
  const double u = into_swing(shape, phase, side);
  if (u < 1) return eased((u - 0.1) / 0.8) - 0.5;
  return 0.5 - (u - 1) * shape.swing / (1 - shape.swing);
}

// Turning displacement of the left foot, in reaches; the right foot's is the opposite. From +1 to -1 in
// single support, back in double support, when both soles slip and the body turns.
double turning_at(const Shape& shape, double phase) {
  const double p = fraction(2 * (phase - shape.lag - 0.25 + shape.swing / 2));
  const double single = 2 * shape.swing;
  return p < single ? 1 - 2 * eased((p / single - 0.1) / 0.8)
                    : 2 * eased(((p - single) / (1 - single) - 0.1) / 0.8) - 1;
}

Vector3d hip_middle(const Stance& stance) {
  return {stance.x, 0, stance.z};
}
Eigen::Matrix3d trunk_axes(const Stance& stance) {
  return (AngleAxisd(stance.pitch, Vector3d::UnitY()) * AngleAxisd(stance.roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

JointAngles home() {
  JointAngles angles{};
  angles[host::l_sh_pitch] = angles[host::r_sh_pitch] = 10 * kDegree;
  angles[host::l_sh_roll] = 12 * kDegree;
  angles[host::r_sh_roll] = -12 * kDegree;
  angles[host::l_elbow] = angles[host::r_elbow] = -40 * kDegree;
  place_legs(angles, {}, {});
  return angles;
}

// A foot is flat and points straight ahead if hip roll = -roll and the pitch joints sum up to -pitch. The
// leg's plane is then vertical, so the ankle is below the hip and only x and z are free.
void place_legs(JointAngles& angles, const Stance& stance, const Feet& feet) {
  const Eigen::Matrix3d axes = trunk_axes(stance);
  const auto place = [&](Side side, double forward, double lift) {
    const Vector3d hip =
        hip_middle(stance) + axes * Vector3d(0, side == Side::left ? kLeg.hip_y : -kLeg.hip_y, 0);
    // From hip to ankle, floor frame, m; limited to the extended leg.
    Vector3d leg(forward - hip.x(), 0, lift + kLeg.ankle_height - hip.z());
    constexpr double kLongest = kLeg.thigh + kLeg.shank - 1e-4;
    if (leg.norm() > kLongest) leg *= kLongest / leg.norm();
    // Trunk frame.
    const Vector3d ankle = axes.transpose() * (hip + leg - hip_middle(stance));
    if (const auto joints = leg_to(side, ankle, -stance.pitch)) set_leg(angles, side, *joints);
  };
  place(Side::left, feet.left_forward, feet.left_lift);
  place(Side::right, feet.right_forward, feet.right_lift);
}

Vector3d centre_over_feet(const Stance& stance) {
  JointAngles angles = home();
  place_legs(angles, stance, {});
  return hip_middle(stance) + trunk_axes(stance) * centre_of_mass(angles);
}

// C (1 + h w^2 / g) of the cart-table model (gait.h), m.
double zmp_amplitude(const Shape& shape, double roll) {
  const Vector3d centre = centre_over_feet({.roll = roll});
  const double w = 2 * std::numbers::pi / shape.period;
  return std::abs(centre.y()) * (1 + centre.z() * w * w / kGravity);
}

double inner_edge(double roll) {
  return kLeg.hip_y * std::cos(roll) - kHalfSole;
}

// Smallest roll for which the ZMP is `margin` inside the sole at lift-off:
//   zmp_amplitude(roll) cos(pi swing) = inner_edge(roll) + margin, by bisection.
double roll_for(const Shape& shape) {
  const auto missing = [&](double roll) {
    return inner_edge(roll) + shape.margin -
           zmp_amplitude(shape, roll) * std::cos(std::numbers::pi * shape.swing);
  };
  double low = 0, high = shape.max_roll;
  if (missing(high) > 0) return high;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (missing(middle) > 0 ? low : high) = middle;
  }
  return high;
}

double roll_at(double roll, double phase, double amplitude) {
  return -amplitude * roll * std::sin(2 * std::numbers::pi * phase);
}

double left_share(const Shape& shape, double phase, double amplitude) {
  if (amplitude <= 0) return 0.5;
  if (into_swing(shape, phase, Side::right) < 1) return 1;
  if (into_swing(shape, phase, Side::left) < 1) return 0;
  return 0.5;
}

JointAngles legs_at(const Shape& shape, double roll, double phase, const Steps& steps) {
  JointAngles angles = home();
  const double turn = steps.reach * turning_at(shape, phase);
  const double a = steps.amplitude;
  const Feet feet{.left_forward = a * (steps.left * walking_at(shape, phase, Side::left) + turn),
                  .left_lift = a * steps.lift * lift_of(shape, phase, Side::left),
                  .right_forward = a * (steps.right * walking_at(shape, phase, Side::right) - turn),
                  .right_lift = a * steps.lift * lift_of(shape, phase, Side::right)};
  Stance stance;
  stance.roll = std::clamp(roll_at(roll, phase, a) + steps.roll, -kMaxRoll, kMaxRoll);
  stance.pitch += steps.lean;
  stance.z += steps.height;
  place_legs(angles, stance, feet);
  return angles;
}

}  // namespace kaz::motion
