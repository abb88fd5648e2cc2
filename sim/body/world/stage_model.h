// The constant part of a world: numbered bodies, names, scene, shapes, kicks and pushes.
// SPDX-License-Identifier: Apache-2.0
//
// A StageModel is built once and then shared by all clones of a world, also across threads.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/body/contact/contact_model.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"
#include "sim/body/world/world.h"

namespace kaz::sim {

// Returns the world pose of the robot's root link at the start, in the zero posture. The soles are on the
// ground at WorldModel::robot_start, or half a meter above it if `hung` (suspended). A fixed base is at
// robot_start itself.
Eigen::Isometry3d root_at_start(const WorldModel& world, const RobotModel& robot, bool hung);

struct StageModel {
  // Precondition, checked by make_world(): the world's feet are links of the robot, and pushed links can
  // move.
  StageModel(const WorldModel& world, const RobotModel& robot, const WorldOptions& options);

  // Bodies are numbered: first the robot's links in the order of RobotModel::links, then the objects that can
  // move.
  struct Body {
    RigidLink rigid;    // without visuals and collision shapes
    bool moves = true;  // false: fixed at `start`
    Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  // world pose of the link's frame
  };
  // Velocity change of an object, m/s, or impulse on a robot link, N s. World axes.
  struct Kick {
    std::int64_t step = 0;
    int body = 0;
    Eigen::Vector3d change = Eigen::Vector3d::Zero();
  };

  std::vector<Body> bodies;
  ContactModel contacts;
  std::vector<std::string> joint_order, link_order;
  std::map<std::string, RobotFrame> link_frames;  // by link name
  // By model name: world pose of the model's first link.
  std::map<std::string, Eigen::Isometry3d> fixed_objects;
  std::map<std::string, int> objects;  // by name of a movable model: body number of its first link
  // Sorted by time, latest first: the next kick is the last element.
  std::vector<Kick> kicks;
  // Sorted like `kicks`; step numbers count from the robot's first step.
  std::vector<Kick> pushes;
  std::vector<int> feet;    // links; the robot's first step is when one of them rises
  std::vector<int> frames;  // body numbers, indexed by scene frame - 1
  Scene scene;
  int head_frame = -1;  // scene frame of the link with both eyes; -1: none

 private:
  int add_frame(const std::string& name, int body);
  void add_visuals(const RigidLink& link, int frame, const Eigen::Isometry3d& in_frame);
  int add_body(const RigidLink& link, const Eigen::Isometry3d& start, bool moves);
  void add_robot(const RobotModel& robot, const Eigen::Isometry3d& root);
  void add_object(const WorldBody& object, double step_s);
  void add_push(const Push& push, double step_s);
};

}  // namespace kaz::sim
