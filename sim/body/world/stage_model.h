// The constant part of a world: numbered bodies, names, scene, shapes, kicks and pushes.
// SPDX-License-Identifier: Apache-2.0
//
// A StageModel is built once. All clones of a world share the StageModel, even if the clones run in different
// threads.
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
// ground at WorldModel::robot_start. If `hung` is true (suspended robot), the soles are half a meter above
// the ground. A root link that is fixed in the world has the pose robot_start.
Eigen::Isometry3d root_at_start(const WorldModel& world, const RobotModel& robot, bool hung);

struct StageModel {
  // Precondition: All names in WorldModel::feet and WorldModel::pushes are names of robot links, and all
  // pushed links can move. make_world() checks this precondition.
  StageModel(const WorldModel& world, const RobotModel& robot, const WorldOptions& options);

  // A body of the world. The robot's links have the first body numbers, in the order of RobotModel::links.
  // The movable objects have the next numbers.
  struct Body {
    RigidLink rigid;    // without visuals and collision shapes
    bool moves = true;  // false: the body is fixed at the pose `start`
    // World pose of the link's frame at the start.
    Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  };
  // Velocity change of an object (m/s), or impulse on a robot link (N s), in world axes.
  struct Kick {
    std::int64_t step = 0;
    int body = 0;
    Eigen::Vector3d change = Eigen::Vector3d::Zero();
  };

  std::vector<Body> bodies;
  ContactModel contacts;
  std::vector<std::string> joint_order, link_order;
  std::map<std::string, RobotFrame> link_frames;  // frames of the robot's links, by link name
  // World pose of the first link of each fixed model, by model name.
  std::map<std::string, Eigen::Isometry3d> fixed_objects;
  // Body number of the first link of each movable model, by model name.
  std::map<std::string, int> objects;
  // Kicks sorted by time, latest first. The next kick to apply is the last element.
  std::vector<Kick> kicks;
  // Pushes, sorted like `kicks`. For a push, Kick::step is the number of simulation steps after the robot's
  // first footstep. If `feet` is empty, the pushes are in `kicks` instead, and this vector
  // is empty.
  std::vector<Kick> pushes;
  // Joints of the world with body numbers in place of indices; -1: a fixed body. Joints between two fixed
  // bodies, or of a body with itself, are left out.
  std::vector<WorldJoint> joints;
  bool has_joint(int body) const;
  std::vector<int> feet;    // body numbers of the feet (WorldModel::feet)
  std::vector<int> frames;  // frames[k] is the body number of scene frame k + 1
  Scene scene;
  int head_frame = -1;  // scene frame of the link with both eyes; -1: none

 private:
  int add_frame(const std::string& name, int body);
  void add_visuals(const RigidLink& link, int frame, const Eigen::Isometry3d& in_frame);
  int add_body(const RigidLink& link, const Eigen::Isometry3d& start, bool moves);
  void add_robot(const RobotModel& robot, const Eigen::Isometry3d& root);
  // Returns the body number; -1: the object is fixed.
  int add_object(const WorldBody& object, int group, double step_s);
  void add_joints(const WorldModel& world, const std::vector<int>& numbers);
  void add_push(const Push& push, double step_s);
};

}  // namespace kaz::sim
