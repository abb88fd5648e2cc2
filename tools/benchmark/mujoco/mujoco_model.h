// Writes the robot and its world as a model file of MuJoCo.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "sim/body/description/motor_file.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim::bench {

struct MujocoSettings {
  double step_s = 0.001;
  // MuJoCo's `solref` of contacts and stops. Positive: time constant (s) and damping ratio; MuJoCo's
  // default of 20 ms lets a sole sink. Negative: -stiffness (1/s^2) and -damping (1/s).
  std::array<double, 2> solref{0.004, 1};
  // MuJoCo's impedance of contacts, at contact and 1 mm deep.
  std::array<double, 2> solimp{0.9, 0.95};
  double impratio = 1;  // MuJoCo's ratio of the impedances of friction and of the normal force
  bool fixed_base = false;
  double stop_margin_rad = 0;  // angle from a joint's limit in the robot file to the joint's stop
  // Number of nearest ancestors with which a link does not collide.
  int exempt_generations = 0;
};

// Returns the model as MJCF text. The robot's links are named "link0", "link1" and so on, in the order of
// RobotModel::links. The world's moving bodies are named "body0" and so on. Joints are named "joint0" and so
// on, in the order of RobotModel::joints. `root`: pose of the root link in the world.
//
// Terms of the motor model in MuJoCo: rotor inertia is `armature`, back-EMF is `damping`, and dry friction is
// `frictionloss`. MuJoCo's Euler step treats `damping` implicitly. MujocoWorld applies the stall torque.
// Backlash is not modeled.
std::string mujoco_model(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                         const Eigen::Isometry3d& root, const MujocoSettings& settings);

}  // namespace kaz::sim::bench
