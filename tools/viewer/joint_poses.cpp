// Forward kinematics of the robot's links, and the floor below them.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/joint_poses.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kaz::viewer {

std::vector<sim::ros::NamedPose> JointPoses::at(std::span<const double, KZ_JOINTS> angles) const {
  std::vector<Eigen::Isometry3d> links(model_.links.size(), Eigen::Isometry3d::Identity());
  for (std::size_t i = 1; i < links.size(); ++i) {
    const sim::RobotLink& link = model_.links[i];
    const auto parent = static_cast<std::size_t>(link.parent);
    links[i] = links[parent] * model_.links[parent].at_zero.inverse() * link.at_zero;
    if (link.joint < 0) continue;
    const sim::RobotJoint& joint = model_.joints[static_cast<std::size_t>(link.joint)];
    const auto coupling = joint.follows.value_or(sim::JointCoupling{link.joint});
    if (coupling.joint >= KZ_JOINTS) continue;
    const double angle =
        coupling.ratio * angles[static_cast<std::size_t>(coupling.joint)] + coupling.offset;
    const Eigen::Vector3d axis = link.at_zero.linear().transpose() * joint.axis;
    links[i] = links[i] * sim::joint_motion(joint, axis, angle);
  }
  if (!hangs_) {
    const Eigen::Isometry3d root = standing(links);
    for (Eigen::Isometry3d& link : links) link = root * link;
  }
  std::vector<sim::ros::NamedPose> poses;
  for (const auto& [name, frame] : model_.frames)
    poses.emplace_back(name, links[static_cast<std::size_t>(frame.link)] * frame.in_link);
  return poses;
}

// Pose of the root, of which `links` are given, in which the lowest of the links that end a chain is level,
// as it is at the zero posture, and the robot's lowest point is on the floor.
Eigen::Isometry3d JointPoses::standing(const std::vector<Eigen::Isometry3d>& links) const {
  if (model_.fixed_base || links.empty()) return Eigen::Isometry3d::Identity();
  const auto bottom = [&](std::size_t i, const Eigen::Matrix3d& turn) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const sim::CollisionShape& shape : model_.links[i].rigid.collisions) {
      const Eigen::Isometry3d at = Eigen::Isometry3d(turn) * links[i] * shape.in_link;
      lowest = std::min(lowest, sim::extent(shape.shape, at).min().z());
    }
    return lowest;
  };
  std::vector<bool> carries(links.size(), false);
  for (const sim::RobotLink& link : model_.links) {
    if (link.parent >= 0) carries[static_cast<std::size_t>(link.parent)] = true;
  }
  std::size_t foot = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < links.size(); ++i) {
    const double at = carries[i] ? lowest : bottom(i, Eigen::Matrix3d::Identity());
    if (at < lowest) {
      lowest = at;
      foot = i;
    }
  }
  Eigen::Isometry3d root = Eigen::Isometry3d::Identity();
  root.linear() = model_.links[foot].at_zero.linear() * links[foot].linear().transpose();
  double height = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < links.size(); ++i)
    height = std::min(height, bottom(i, root.linear()));
  if (std::isfinite(height)) root.translation().z() = -height;
  return root;
}

}  // namespace kaz::viewer
