// Keyframes of picking up, and the hip position for static balance.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/reach.h"

#include <algorithm>
#include <cmath>

namespace kaz::motion {

namespace {

using Eigen::AngleAxisd, Eigen::Vector2d, Eigen::Vector3d;

// Offset of the grasp's target from the ball's centre, m: clearance for the fixed jaw on the inner side.
constexpr double kInwards = 0.012, kAbove = 0.003;
// Range of bending, height of the hips (m) and pitch of the trunk: from what suffices for a near ball to the
// deepest.
constexpr double kBentZ = 0.110, kBentPitch = 50 * kDegree, kBentCom = 0.020;
constexpr double kDeepestZ = 0.098, kDeepestPitch = 62 * kDegree;
constexpr int kBends = 7;
constexpr double kSlack =
    -10 * kDegree;  // of the elbow before it is straight: reserve for aiming again
constexpr double kForward =
    50 * kDegree;  // offset of the shoulder before it swings down and when it lifts

// Hand angles: a ball of 20 mm radius stops the jaw at about 3 degrees. For a radius r, the jaw, 28 mm long
// to the ball's centre, closes further by 2 atan((20 mm - r) / 28 mm). Its target is 11 degrees beyond: at
// 0.8 of full duty per rad that is a torque of 0.3 Nm, which holds the ball without squeezing it out.
constexpr double kOpen = -60 * kDegree, kStopAt20 = 3 * kDegree, kSqueeze = 11 * kDegree;
constexpr double kJaw = 0.028;

// Smoothstep: cubic from 0 to 1 with zero slope at both ends.
double eased(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

ArmAngles mirrored(ArmAngles arm, Side hand) {
  if (hand == Side::left) arm.sh_roll = -arm.sh_roll;
  return arm;
}

ArmAngles mix(const ArmAngles& a, const ArmAngles& b, double u) {
  return {std::lerp(a.sh_pitch, b.sh_pitch, u), std::lerp(a.sh_roll, b.sh_roll, u),
          std::lerp(a.elbow, b.elbow, u)};
}

Side other(Side side) {
  return side == Side::left ? Side::right : Side::left;
}

}  // namespace

// Solves com_x(hips x) = key.com_x by the secant method. The centre of mass, trunk frame, is rotated by the
// pitch and moved to the hips' position above the midpoint of the ankles; tolerance 1e-7 m.
JointAngles Pickup::solve(const Key& key, Side hand, double* hips_x) {
  JointAngles angles = home();
  set_arm(angles, hand, key.arm);
  set_arm(angles, other(hand), key.other);
  angles[hand == Side::left ? host::l_hand : host::r_hand] = key.hand;
  const auto error = [&](double x) {
    place_legs(angles, {.x = x, .z = key.z, .pitch = key.pitch}, {});
    const Vector3d centre =
        AngleAxisd(key.pitch, Vector3d::UnitY()) * centre_of_mass(angles) + Vector3d(x, 0, key.z);
    return centre.x() - key.com_x;
  };
  double a = -0.02, b = 0.01, fa = error(a), fb = error(b);
  for (int i = 0; i < 20 && std::abs(fb) > 1e-7 && fa != fb; ++i) {
    const double c = std::clamp(b - fb * (b - a) / (fb - fa), -0.08, 0.08);
    a = b;
    fa = fb;
    b = c;
    fb = error(b);
  }
  if (hips_x) *hips_x = b;
  return within_limits(angles);
}

// Fixed-point iteration: the arm's mass shifts the hips a little, and with them the shoulder. The target is
// transformed to the trunk frame and solved in closed form (arm_to).
std::optional<ArmAngles> Pickup::arm_onto(Key key, Side hand, const Vector2d& ball, double radius) {
  const double inwards = hand == Side::right ? kInwards : -kInwards;
  const Vector3d target(ball.x(), ball.y() + inwards, radius + kAbove);
  for (int i = 0; i < 8; ++i) {
    double x = 0;
    solve(key, hand, &x);
    const Vector3d in_trunk =
        AngleAxisd(-key.pitch, Vector3d::UnitY()) * (target - Vector3d(x, 0, key.z));
    const auto arm = arm_to(hand, in_trunk);
    if (!arm) return std::nullopt;
    key.arm = *arm;
  }
  return key.arm;
}

std::optional<Pickup> Pickup::plan(Side hand, const Vector2d& ball, double radius) {
  const JointAngles stand = home();
  Key start;
  start.z = Stance{}.z;
  start.pitch = Stance{}.pitch;
  start.com_x = centre_over_feet({}).x();
  start.arm = arm_of(stand, hand);
  start.other = arm_of(stand, other(hand));

  Key bent;
  bent.z = kBentZ;
  bent.pitch = kBentPitch;
  bent.com_x = kBentCom;
  bent.arm = mirrored({-58.4 * kDegree, 13.3 * kDegree, -13.5 * kDegree}, hand);
  bent.other = mirrored({40 * kDegree, 12 * kDegree, 0}, hand);  // backwards, as a counterweight
  bent.hand = kOpen;
  std::optional<ArmAngles> down;
  for (int i = 0; i < kBends && (!down || down->elbow > kSlack); ++i) {
    const double depth = i / (kBends - 1.0);
    bent.z = std::lerp(kBentZ, kDeepestZ, depth);
    bent.pitch = std::lerp(kBentPitch, kDeepestPitch, depth);
    down = arm_onto(bent, hand, ball, radius);
  }
  if (!down) return std::nullopt;
  bent.arm = *down;

  Pickup pickup;
  pickup.hand_ = hand;
  pickup.radius_ = radius;
  pickup.stopped_ = kStopAt20 + 2 * std::atan2(0.020 - radius, kJaw);
  pickup.closed_ = std::min(pickup.stopped_ + kSqueeze, 28 * kDegree);
  const auto then = [&](double seconds, auto change) {
    Key next = pickup.keys_.back();
    next.time += seconds;
    change(next);
    pickup.keys_.push_back(next);
  };
  const auto wait = [](Key&) {};
  pickup.keys_ = {start};
  then(1.6, [&](Key& key) {
    const double time = key.time;
    key = bent;
    key.time = time;
    key.arm.sh_pitch -= kForward;
  });
  then(0.3, wait);
  then(1.0, [&](Key& key) { key.arm = *down; });
  then(0.2, wait);
  then(0.8, [&](Key& key) { key.hand = pickup.closed_; });
  then(0.4, wait);
  then(0.8, [&](Key& key) { key.arm.sh_pitch -= kForward; });
  then(1.6, [&](Key& key) {
    key.z = start.z;
    key.pitch = start.pitch;
    key.com_x = start.com_x;
    key.arm = mirrored({-30 * kDegree, -5 * kDegree, -60 * kDegree}, hand);
    key.other = start.other;
  });
  return pickup;
}

std::optional<Pickup> Pickup::aimed_at(const Vector2d& ball) const {
  Pickup again = *this;
  Key bent = keys_[kDown];
  const auto down = arm_onto(bent, hand_, ball, radius_);
  if (!down) return std::nullopt;
  for (const Part part : {kDown, kRested, kClosed, kFirm})
    again.keys_[static_cast<std::size_t>(part)].arm = *down;
  again.keys_[kLifted].arm = *down;
  again.keys_[kLifted].arm.sh_pitch -= kForward;
  return again;
}

Pickup::Key Pickup::between(const Key& a, const Key& b, double u) {
  Key key;
  key.z = std::lerp(a.z, b.z, u);
  key.pitch = std::lerp(a.pitch, b.pitch, u);
  key.com_x = std::lerp(a.com_x, b.com_x, u);
  key.arm = mix(a.arm, b.arm, u);
  key.other = mix(a.other, b.other, u);
  key.hand = std::lerp(a.hand, b.hand, u);
  return key;
}

Pickup::Key Pickup::key_at(double time_s) const {
  std::size_t next = 1;
  while (next + 1 < keys_.size() && keys_[next].time < time_s) ++next;
  const Key &a = keys_[next - 1], &b = keys_[next];
  return between(a, b, eased((time_s - a.time) / (b.time - a.time)));
}

JointAngles Pickup::at(double time_s) const {
  return solve(key_at(time_s), hand_);
}

// Opens the hand, raises the arm forward, stands up; three eased segments.
JointAngles Pickup::back(double from_s, double time_s) const {
  const Key from = key_at(from_s);
  Key opened = from;
  opened.hand = kOpen;
  Key lifted = opened;
  const double max_pitch = keys_[kBent].pitch;
  const double bend = (max_pitch - from.pitch) / (max_pitch - Stance{}.pitch);
  lifted.arm.sh_pitch =
      std::min(opened.arm.sh_pitch, std::lerp(keys_[kBent].arm.sh_pitch, from.arm.sh_pitch, bend));
  const double open_s = 0.8, lift_s = 1.0, stand_s = kGiveUp_s - open_s - lift_s;
  if (time_s < open_s) return solve(between(from, opened, eased(time_s / open_s)), hand_);
  time_s -= open_s;
  if (time_s < lift_s) return solve(between(opened, lifted, eased(time_s / lift_s)), hand_);
  return solve(between(lifted, keys_[kStart], eased((time_s - lift_s) / stand_s)), hand_);
}

}  // namespace kaz::motion
