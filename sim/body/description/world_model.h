// The robot's environment as the SDF world describes it. Supported subset: docs/reference/worlds.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// At `time` the velocity is added to that of the object.
struct Kick {
  double time_s = 0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, world axes
};

// At `time` a link of the robot has this impulse, at its centre of mass. WorldModel::feet: since when.
struct Push {
  double time_s = 0;
  std::string link;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // N s, world axes
};

inline constexpr double kFirstStep = 0.005;  // m

struct WorldBody {
  std::string model;
  RigidLink rigid;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the world, at the start
  bool fixed = false;
  std::vector<Kick> kicks;  // by time
};

struct WorldModel {
  Eigen::Vector3d gravity{0, 0, -9.81};
  std::vector<WorldBody> bodies;
  Light light;
  // Where the robot starts: the point between its soles, x forward.
  Eigen::Isometry3d robot_start = Eigen::Isometry3d::Identity();
  std::vector<Push> pushes;  // on the robot, by time
  // Links of the robot. Pushes are timed from its first step: when one of these has risen by kFirstStep.
  // Empty: from the start.
  std::vector<std::string> feet;
};

// Errors name file and line. Never touches the network.
Result<WorldModel> load_world(const std::string& sdf_path);

}  // namespace kaz::sim
