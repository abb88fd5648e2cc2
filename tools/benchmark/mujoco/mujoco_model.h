// The robot and its world as MuJoCo's model file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/body/description/motor_file.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim::bench {

struct MujocoSettings {
  double step_s = 0.001;
  bool fixed_base = false;
  double stop_margin_rad = 0;  // of a joint's stop beyond its limit in the robot file
  // Links this near in the tree, by number of parents, do not collide with each other.
  int exempt_generations = 0;
};

// MJCF. Bodies are named "link0" ... in the order of RobotModel::links, then "body0" ... for the world's
// moving bodies, joints "joint0" ... in the order of RobotModel::joints. `root`: the root link's pose in the
// world.
//
// The motor line's terms: rotor inertia is `armature`, back-EMF is `damping` (implicit in MuJoCo's Euler
// step), dry friction is `frictionloss`. Its torque at stall is applied from outside. There is no backlash.
std::string mujoco_model(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                         const Eigen::Isometry3d& root, const MujocoSettings& settings);

}  // namespace kaz::sim::bench
