// Picking up a ball from the floor: poses and their order.
// SPDX-License-Identifier: Apache-2.0
#include "tests/gait/catch_motion.h"

#include <algorithm>
#include <cmath>

#include "tests/gait/gait.h"

namespace kaz::gait {
namespace {

using Eigen::Vector3d;
using host::Side;

constexpr double kRadius = 0.020;
// Where the grasp aims beside the ball's centre: room for the fixed jaw, which is on the inner side.
constexpr double kInwards = 0.012, kAbove = 0.003;
constexpr double kStandingCom = 0.0045, kBentCom = 0.020;

double eased(double u) {
  return u * u * (3 - 2 * u);
}
double between(double a, double b, double u) {
  return a + (b - a) * u;
}

}  // namespace

CatchMotion::CatchMotion(const sim::RobotModel& robot)
    : tree_(robot, Eigen::Isometry3d::Identity(), false) {}

double CatchMotion::mass_centre_x(const JointAngles& angles, double x, const Key& key) {
  for (std::size_t j = 0; j < angles.size(); ++j) {
    const int dof = tree_.dof_of_joint(static_cast<int>(j)) - tree_.root_dofs();
    tree_.angle[static_cast<std::size_t>(dof)] = angles[j];
  }
  tree_.root_at = {x, 0, key.z};
  tree_.root_turn = Eigen::AngleAxisd(key.pitch, Vector3d::UnitY());
  tree_.place();
  return tree_.mass_centre().x();
}

// The hips where the centre of mass is as asked, by the secant method: the trunk's weight goes with them.
JointAngles CatchMotion::solve(const Key& key) {
  JointAngles angles = standing();
  for (const auto& [arm, first] :
       {std::pair{key.left, host::l_sh_pitch}, {key.right, host::r_sh_pitch}}) {
    double* const out = angles.data() + first;
    out[0] = arm.pitch;
    out[1] = arm.roll;
    out[2] = arm.elbow;
  }
  angles[host::r_hand] = key.hand;
  const auto error = [&](double x) {
    for (const Side side : {Side::left, Side::right})
      set_leg(angles, side, leg_to({.x = x, .z = key.z, .pitch = key.pitch}, side, 0, 0));
    return mass_centre_x(angles, x, key) - key.com_x;
  };
  double a = -0.02, b = 0.01, fa = error(a), fb = error(b);
  for (int i = 0; i < 30 && std::abs(fb) > 1e-9 && fa != fb; ++i) {
    const double c = std::clamp(b - fb * (b - a) / (fb - fa), -0.08, 0.08);
    a = b;
    fa = fb;
    b = c;
    fb = error(b);
  }
  return angles;
}

Vector3d CatchMotion::grasp_at(const Key& key) {
  solve(key);  // leaves the tree there
  return tree_.origin(forearm_) + tree_.axes(forearm_) * grasp();
}

// Newton's method on the three joints of the arm, with differences for the derivatives.
Result<CatchMotion::Arm> CatchMotion::reach(Key key, const Vector3d& target) {
  constexpr double kProbe = 1e-5, kLargestStep = 0.2;
  for (int i = 0; i < 50; ++i) {
    const Vector3d at = grasp_at(key);
    const Vector3d missing = target - at;
    if (missing.norm() < 1e-6) return key.right;
    Eigen::Matrix3d slope;
    double* const angle[] = {&key.right.pitch, &key.right.roll, &key.right.elbow};
    for (int k = 0; k < 3; ++k) {
      *angle[k] += kProbe;
      slope.col(k) = (grasp_at(key) - at) / kProbe;
      *angle[k] -= kProbe;
    }
    // Damped: near a straight elbow one direction has next to no slope.
    const Vector3d step = (slope.transpose() * slope + 1e-8 * Eigen::Matrix3d::Identity())
                              .ldlt()
                              .solve(slope.transpose() * missing);
    for (int k = 0; k < 3; ++k) *angle[k] += std::clamp(step[k], -kLargestStep, kLargestStep);
  }
  return fail(Fault::usage, "the arm does not reach a ball at (" + std::to_string(target.x()) +
                                ", " + std::to_string(target.y()) +
                                ") m from the ankles; place it 80 to 120 mm ahead");
}

Result<CatchMotion> CatchMotion::plan(const sim::RobotModel& robot, double ball_x, double ball_y) {
  const auto forearm = robot.frames.find("r_elbow");
  if (robot.joints.size() != KZ_JOINTS || forearm == robot.frames.end())
    return fail(Fault::usage, "the robot " + robot.name + " is no Kaz: it has no such arm");
  CatchMotion motion(robot);
  motion.forearm_ = forearm->second.link;

  const Arm left_home{10 * kDegree, 12 * kDegree, -40 * kDegree};
  const Arm right_home{10 * kDegree, -12 * kDegree, -40 * kDegree};
  const Arm left_back{40 * kDegree, 12 * kDegree, 0};  // a counterweight
  Key bent;
  bent.z = 0.110;
  bent.pitch = 50 * kDegree;
  bent.com_x = kBentCom;
  bent.left = left_back;
  bent.right = {-58.4 * kDegree, 13.3 * kDegree, -13.5 * kDegree};  // to search from
  const auto down = motion.reach(bent, {ball_x, ball_y + kInwards, kRadius + kAbove});
  if (!down) return tl::unexpected(down.error());
  Arm forward = *down;
  forward.pitch -= 50 * kDegree;

  const double open = -60 * kDegree, closed = 14 * kDegree;
  const auto then = [&](double seconds, auto change) {
    Key next = motion.keys_.back();
    next.time += seconds;
    change(next);
    motion.keys_.push_back(next);
  };
  const auto wait = [](Key&) {};
  motion.keys_ = {{.com_x = kStandingCom, .right = right_home, .left = left_home}};
  motion.keys_.back().z = Body{}.z;
  motion.keys_.back().pitch = Body{}.pitch;
  then(1.6, [&](Key& key) {
    const double time = key.time;
    key = bent;
    key.time = time;
    key.right = forward;
    key.hand = open;
  });
  then(0.3, wait);
  then(1.0, [&](Key& key) { key.right = *down; });
  then(0.2, wait);
  then(0.8, [&](Key& key) { key.hand = closed; });
  then(0.4, wait);
  then(0.8, [&](Key& key) { key.right = forward; });
  then(1.6, [&](Key& key) {
    key.z = Body{}.z;
    key.pitch = Body{}.pitch;
    key.com_x = kStandingCom;
    key.right = {-30 * kDegree, -5 * kDegree, -60 * kDegree};
    key.left = left_home;
  });
  return motion;
}

double CatchMotion::duration() const {
  return keys_.back().time;
}

JointAngles CatchMotion::at(double time_s) {
  std::size_t next = 1;
  while (next + 1 < keys_.size() && keys_[next].time < time_s) ++next;
  const Key &a = keys_[next - 1], &b = keys_[next];
  const double u = eased(std::clamp((time_s - a.time) / (b.time - a.time), 0.0, 1.0));
  Key key = a;
  key.z = between(a.z, b.z, u);
  key.pitch = between(a.pitch, b.pitch, u);
  key.com_x = between(a.com_x, b.com_x, u);
  for (const auto arm : {&Key::right, &Key::left}) {
    (key.*arm).pitch = between((a.*arm).pitch, (b.*arm).pitch, u);
    (key.*arm).roll = between((a.*arm).roll, (b.*arm).roll, u);
    (key.*arm).elbow = between((a.*arm).elbow, (b.*arm).elbow, u);
  }
  key.hand = between(a.hand, b.hand, u);
  return solve(key);
}

}  // namespace kaz::gait
