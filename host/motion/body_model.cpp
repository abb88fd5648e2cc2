// The links as a table, and one pass over it.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/body_model.h"

namespace kaz::motion {

namespace {

using namespace host;
using Eigen::Vector3d;

const Vector3d kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1), kMinusX(-1, 0, 0);
const Vector3d kTrunkCentre(-0.005, 0, 0.05);

std::array<Link, KZ_JOINTS> make_links() {
  std::array<Link, KZ_JOINTS> all;
  all[neck_pan] = {-1, {0, 0, 0.118}, kZ, 0.020, {0, 0, 0.008}};
  all[neck_tilt] = {neck_pan, {0, 0, 0.018}, kY, 0.060, {0.010, 0, 0.022}};
  const auto side = [&all](double y, int sh_pitch, int sh_roll, int elbow, int hand, int hip_roll,
                           int hip_pitch, int knee, int ankle) {
    const auto at = [&all](int joint) -> Link& { return all[static_cast<std::size_t>(joint)]; };
    at(sh_pitch) = {-1, {0, y * 0.080, 0.100}, kY, 0.050, {0, y * 0.005, 0}};
    at(sh_roll) = {sh_pitch, {0, 0, 0}, kX, 0.070, {0, 0, -0.035}};
    at(elbow) = {sh_roll, {0, 0, -0.070}, kY, 0.060, {0, 0, -0.030}};
    at(hand) = {elbow, {0, y * 0.024, -0.065}, y > 0 ? kMinusX : kX, 0.015, {0, 0, -0.020}};
    at(hip_roll) = {-1, {0, y * kLeg.hip_y, 0}, kX, 0.060, {-0.005, 0, -0.005}};
    at(hip_pitch) = {hip_roll, {0, 0, 0}, kY, 0.090, {0, 0, -0.035}};
    at(knee) = {hip_pitch, {0, 0, -kLeg.thigh}, kY, 0.085, {0, 0, -0.035}};
    at(ankle) = {knee, {0, 0, -kLeg.shank}, kY, 0.055, {0.010, 0, -0.018}};
  };
  side(1, l_sh_pitch, l_sh_roll, l_elbow, l_hand, l_hip_roll, l_hip_pitch, l_knee, l_ankle_pitch);
  side(-1, r_sh_pitch, r_sh_roll, r_elbow, r_hand, r_hip_roll, r_hip_pitch, r_knee, r_ankle_pitch);
  return all;
}

// Parents before children, whatever the numbers of the joints are.
std::array<std::size_t, KZ_JOINTS> make_order() {
  std::array<std::size_t, KZ_JOINTS> order{};
  std::array<bool, KZ_JOINTS> placed{};
  std::size_t count = 0;
  while (count < order.size()) {
    for (std::size_t j = 0; j < order.size(); ++j) {
      const int parent = links()[j].parent;
      if (placed[j] || (parent >= 0 && !placed[static_cast<std::size_t>(parent)])) continue;
      placed[j] = true;
      order[count++] = j;
    }
  }
  return order;
}

}  // namespace

const std::array<Link, KZ_JOINTS>& links() {
  static const std::array<Link, KZ_JOINTS> all = make_links();
  return all;
}

Poses forward(const JointAngles& angles) {
  static const std::array<std::size_t, KZ_JOINTS> order = make_order();
  Poses poses;
  for (const std::size_t j : order) {
    const Link& link = links()[j];
    const Eigen::Isometry3d own =
        Eigen::Translation3d(link.origin) * Eigen::AngleAxisd(angles[j], link.axis);
    poses[j] = link.parent < 0 ? own : poses[static_cast<std::size_t>(link.parent)] * own;
  }
  return poses;
}

Vector3d centre_of_mass(const JointAngles& angles) {
  const Poses poses = forward(angles);
  Vector3d moment = kTrunkMass * kTrunkCentre;
  for (std::size_t j = 0; j < poses.size(); ++j)
    moment += links()[j].mass * (poses[j] * links()[j].centre);
  return moment / kTotalMass;
}

std::array<Limb, 12> limbs(const JointAngles& angles) {
  const Poses poses = forward(angles);
  std::array<Limb, 12> all;
  std::size_t count = 0;
  const auto add = [&](int joint, const Vector3d& from, const Vector3d& to, double radius_m) {
    const Eigen::Isometry3d& pose = poses[static_cast<std::size_t>(joint)];
    all[count++] = {pose * from, pose * to, radius_m};
  };
  for (const int arm : {l_sh_roll, r_sh_roll}) add(arm, {0, 0, -0.005}, {0, 0, -0.065}, 0.024);
  for (const int forearm : {l_elbow, r_elbow}) add(forearm, {0, 0, 0}, {0, 0, -0.090}, 0.034);
  for (const int hand : {l_hand, r_hand}) add(hand, {0, 0, 0}, {0, 0, -0.030}, 0.022);
  for (const int thigh : {l_hip_pitch, r_hip_pitch})
    add(thigh, {0, 0, 0}, {0, 0, -kLeg.thigh}, 0.028);
  for (const int shank : {l_knee, r_knee}) add(shank, {0, 0, 0}, {0, 0, -kLeg.shank}, 0.028);
  for (const int foot : {l_ankle_pitch, r_ankle_pitch})
    add(foot, {-0.020, 0, -0.015}, {0.040, 0, -0.020}, 0.040);
  return all;
}

Eigen::Isometry3d trunk_from_grasp(const JointAngles& angles, Side hand) {
  return forward(angles)[hand == Side::left ? l_elbow : r_elbow] * Eigen::Translation3d(kGrasp);
}

}  // namespace kaz::motion
