// A known gait of Kaz: walking and turning by slip.
// SPDX-License-Identifier: Apache-2.0
#include "tests/gait/gait.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace kaz::gait {
namespace {

using host::Side;

double fraction(double x) {
  return x - std::floor(x);
}

// From 0 to 1 with no speed at the ends.
double eased(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// Share of its swing that a foot has behind it; 1 or more: it stands.
double into_swing(const Shape& shape, double phase, Side side) {
  const double centre = side == Side::right ? 0.25 : 0.75;
  return fraction(phase - shape.lag - (centre - shape.swing / 2)) / shape.swing;
}

double lift_of(const Shape& shape, double phase, Side side) {
  const double u = into_swing(shape, phase, side);
  return u < 1 ? shape.lift * (1 - std::cos(2 * std::numbers::pi * u)) / 2 : 0;
}

template <class Forward>
JointAngles stepping(const Shape& shape, double phase, double amplitude, Forward forward) {
  JointAngles angles = standing();
  Body body;
  body.roll = -amplitude * shape.roll * std::sin(2 * std::numbers::pi * phase);
  for (const Side side : {Side::left, Side::right}) {
    set_leg(angles, side,
            leg_to(body, side, amplitude * forward(side), amplitude * lift_of(shape, phase, side)));
  }
  return angles;
}

}  // namespace

Leg leg_to(const Body& body, Side side, double forward, double lift) {
  using Eigen::AngleAxisd, Eigen::Vector3d, host::kLeg;
  static_assert(kLeg.thigh == kLeg.shank);
  constexpr double kBone = kLeg.thigh;
  const Vector3d hip = Vector3d(body.x, 0, body.z) +
                       AngleAxisd(body.pitch, Vector3d::UnitY()) *
                           (AngleAxisd(body.roll, Vector3d::UnitX()) *
                            Vector3d(0, side == Side::left ? kLeg.hip_y : -kLeg.hip_y, 0));
  const double along = forward - hip.x(), down = hip.z() - (lift + kLeg.ankle_height);
  const double length = std::min(std::hypot(along, down), 2 * kBone);
  Leg leg;
  leg.hip_roll = -body.roll;
  leg.knee = std::acos(std::clamp(length * length / (2 * kBone * kBone) - 1, -1.0, 1.0));
  const double thigh = std::atan2(-along, down) - std::asin(kBone * std::sin(leg.knee) / length);
  leg.hip_pitch = thigh - body.pitch;
  leg.ankle_pitch = -(thigh + leg.knee);
  return leg;
}

void set_leg(JointAngles& angles, Side side, const Leg& leg) {
  double* const out = angles.data() + (side == Side::left ? host::l_hip_roll : host::r_hip_roll);
  out[0] = leg.hip_roll;
  out[1] = leg.hip_pitch;
  out[2] = leg.knee;
  out[3] = leg.ankle_pitch;
}

JointAngles standing() {
  JointAngles angles{};
  angles[host::l_sh_pitch] = angles[host::r_sh_pitch] = 10 * kDegree;
  angles[host::l_sh_roll] = 12 * kDegree;
  angles[host::r_sh_roll] = -12 * kDegree;
  angles[host::l_elbow] = angles[host::r_elbow] = -40 * kDegree;
  for (const Side side : {Side::left, Side::right}) set_leg(angles, side, leg_to({}, side, 0, 0));
  return angles;
}

JointAngles walking(const Shape& shape, double phase, double amplitude, const Stride& stride) {
  return stepping(shape, phase, amplitude, [&](Side side) {
    const double length = side == Side::left ? stride.left : stride.right;
    const double u = into_swing(shape, phase, side);
    if (u < 1) return length * (eased((u - 0.1) / 0.8) - 0.5);
    return length * (0.5 - (u - 1) * shape.swing / (1 - shape.swing));
  });
}

JointAngles turning(const Shape& shape, double phase, double amplitude, double reach) {
  const double p = fraction(2 * (phase - shape.lag - 0.25 + shape.swing / 2));
  const double single = 2 * shape.swing;
  const double way = p < single ? 1 - 2 * eased((p / single - 0.1) / 0.8)
                                : 2 * eased(((p - single) / (1 - single) - 0.1) / 0.8) - 1;
  return stepping(shape, phase, amplitude,
                  [&](Side side) { return (side == Side::left ? reach : -reach) * way; });
}

}  // namespace kaz::gait
