// What a world knows and never changes: numbered bodies, names, scene, shapes, kicks and pushes.
// SPDX-License-Identifier: Apache-2.0
//
// Built once and then shared by all clones of a world, also in different threads.
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

// Pose of the robot's root link in the world at the start, in its zero posture: above the point between the
// soles, so that these are on the ground, or, `hung`, half a metre above it. A fixed base is at that point.
Eigen::Isometry3d root_at_start(const WorldModel& world, const RobotModel& robot, bool hung);

struct StageModel {
  // Precondition: the world's pushes are on links of the robot that can move (make_world()).
  StageModel(const WorldModel& world, const RobotModel& robot, const WorldOptions& options);

  // Robot links have the numbers of RobotModel::links; the objects that can move follow.
  struct Body {
    RigidLink rigid;    // without visuals and collision shapes
    bool moves = true;  // false: fixed at `start`
    Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  // of the link's frame
  };
  // Of an object, m/s added to its velocity; of a link of the robot an impulse, N s. World axes.
  struct Kick {
    std::int64_t step = 0;
    int body = 0;
    Eigen::Vector3d change = Eigen::Vector3d::Zero();
  };

  std::vector<Body> bodies;
  ContactModel contacts;
  std::vector<std::string> joint_order, link_order;
  std::map<std::string, RobotFrame> link_frames;           // by link name
  std::map<std::string, Eigen::Isometry3d> fixed_objects;  // by model
  std::map<std::string, int> objects;                      // first link of each model that can move
  std::vector<Kick> kicks;                                 // the next one last
  std::vector<Kick> pushes;                                // the same, by step since the first step
  std::vector<int> feet;    // whose rise is the first step of the robot
  std::vector<int> frames;  // body of scene frame 1 onwards
  Scene scene;
  int head_frame = -1;

 private:
  int add_frame(const std::string& name, int body);
  void add_visuals(const RigidLink& link, int frame, const Eigen::Isometry3d& in_frame);
  int add_body(const RigidLink& link, const Eigen::Isometry3d& start, bool moves);
  void add_robot(const RobotModel& robot, const Eigen::Isometry3d& root);
  void add_object(const WorldBody& object, double step_s);
  void add_push(const Push& push, double step_s);
};

}  // namespace kaz::sim
