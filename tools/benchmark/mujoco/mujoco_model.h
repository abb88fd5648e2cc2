// Writes the robot and its world as a model file of MuJoCo.
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
  double stop_margin_rad = 0;  // from a joint's limit in the robot file to its stop
  // A link does not collide with its nearest ancestors, up to this number.
  int exempt_generations = 0;
};

// Returns MJCF. Bodies are named "link0" ... in the order of RobotModel::links, then "body0" ... for the
// world's moving bodies; joints "joint0" ... in the order of RobotModel::joints. `root`: the root link's pose
// in the world.
//
// Terms of the motor line: rotor inertia is `armature`, back-EMF is `damping` (implicit in MuJoCo's Euler
// step), dry friction is `frictionloss`. MujocoWorld applies the stall torque. Backlash is not modeled.
std::string mujoco_model(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                         const Eigen::Isometry3d& root, const MujocoSettings& settings);

}  // namespace kaz::sim::bench
