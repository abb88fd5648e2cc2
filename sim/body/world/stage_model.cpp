// What a world knows and never changes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/world/stage_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace kaz::sim {
namespace {

constexpr double kHungHeight = 0.5;  // m, of the feet above the ground

// Numbers the groups of bodies that joints connect within a model. One number for each body.
std::vector<int> groups_of(const WorldModel& world) {
  std::vector<int> group(world.bodies.size());
  std::iota(group.begin(), group.end(), 0);
  for (const WorldJoint& joint : world.joints) {
    if (joint.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(joint.parent);
    const auto child = static_cast<std::size_t>(joint.child);
    if (world.bodies[parent].model == world.bodies[child].model)
      std::ranges::replace(group, int{group[child]}, int{group[parent]});
  }
  return group;
}

}  // namespace

Eigen::Isometry3d root_at_start(const WorldModel& world, const RobotModel& robot, bool hung) {
  const double feet = hung ? kHungHeight : 0.0;
  const Eigen::AlignedBox3d extent = robot.extent();
  Eigen::Vector3d lift = Eigen::Vector3d::Zero();
  if (!robot.fixed_base) lift.z() = feet - (extent.isEmpty() ? 0.0 : extent.min().z());
  return world.robot_start * Eigen::Translation3d(lift);
}

StageModel::StageModel(const WorldModel& world, const RobotModel& robot,
                       const WorldOptions& options)
    : contacts(robot), joint_order(robot.joint_order()), link_frames(robot.frames) {
  scene.frames.push_back("world");
  scene.light = world.light;
  scene.robot_start = world.robot_start;
  add_robot(robot, root_at_start(world, robot, options.hung));
  const std::vector<int> groups = groups_of(world);
  std::vector<int> numbers;
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    numbers.push_back(add_object(world.bodies[i], groups[i], options.step_s));
  add_joints(world, numbers);
  for (const std::string& foot : world.feet) feet.push_back(link_frames.at(foot).link);
  for (const Push& push : world.pushes) add_push(push, options.step_s);
  // Latest first: the next kick is taken from the end; equal times keep the order of the file.
  for (auto* list : {&kicks, &pushes}) {
    std::reverse(list->begin(), list->end());
    std::stable_sort(list->begin(), list->end(),
                     [](const Kick& a, const Kick& b) { return a.step > b.step; });
  }
}

int StageModel::add_frame(const std::string& name, int body) {
  frames.push_back(body);
  scene.frames.push_back(name);
  return static_cast<int>(scene.frames.size()) - 1;
}

void StageModel::add_visuals(const RigidLink& link, int frame, const Eigen::Isometry3d& in_frame) {
  for (Visual visual : link.visuals) {
    visual.frame = frame;
    visual.in_frame = in_frame * visual.in_frame;
    scene.visuals.push_back(std::move(visual));
  }
}

int StageModel::add_body(const RigidLink& link, const Eigen::Isometry3d& start, bool moves) {
  Body body{link, moves, start};
  body.rigid.visuals.clear();
  body.rigid.collisions.clear();
  bodies.push_back(std::move(body));
  return static_cast<int>(bodies.size()) - 1;
}

void StageModel::add_robot(const RobotModel& robot, const Eigen::Isometry3d& root) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const RobotLink& link = robot.links[i];
    const Eigen::Isometry3d at = root * link.at_zero;
    const bool moves = i > 0 || !robot.fixed_base;
    const int body = add_body(link.rigid, at, moves);
    contacts.add_robot_link(link.rigid, static_cast<int>(i), moves ? body : -1, at);
    const int frame = add_frame(link.rigid.name, body);
    link_order.push_back(link.rigid.name);
    add_visuals(link.rigid, frame, Eigen::Isometry3d::Identity());
    if (robot.eyes_link() == static_cast<int>(i)) head_frame = frame;
  }
}

int StageModel::add_object(const WorldBody& object, int group, double step_s) {
  if (object.fixed) {
    contacts.add_object(object.rigid, -1, object.pose, group);
    add_visuals(object.rigid, 0, object.pose);
    fixed_objects.emplace(object.model, object.pose);
    return -1;
  }
  const int body = add_body(object.rigid, object.pose, true);
  contacts.add_object(object.rigid, body, object.pose, group);
  add_visuals(object.rigid, add_frame(object.rigid.name, body), Eigen::Isometry3d::Identity());
  objects.emplace(object.model, body);
  for (const sim::Kick& kick : object.kicks) {
    kicks.push_back({std::llround(kick.time_s / step_s), body, kick.velocity});
  }
  return body;
}

void StageModel::add_joints(const WorldModel& world, const std::vector<int>& numbers) {
  for (WorldJoint joint : world.joints) {
    for (int* body : {&joint.parent, &joint.child})
      if (*body >= 0) *body = numbers[static_cast<std::size_t>(*body)];
    if (joint.parent != joint.child) joints.push_back(std::move(joint));
  }
}

bool StageModel::has_joint(int body) const {
  return std::ranges::any_of(joints, [body](const WorldJoint& joint) {
    return joint.parent == body || joint.child == body;
  });
}

void StageModel::add_push(const Push& push, double step_s) {
  (feet.empty() ? kicks : pushes)
      .push_back(
          {std::llround(push.time_s / step_s), link_frames.at(push.link).link, push.impulse});
}

}  // namespace kaz::sim
