// The robot's environment, loaded from an SDF world. Supported subset: docs/reference/worlds.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// Velocity change of an object at a given time.
struct Kick {
  double time_s = 0;
  // m/s, world axes, added to the object's velocity.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

// Impulse on a link of the robot at its center of mass.
struct Push {
  double time_s = 0;  // from the start, or from the first step if WorldModel::feet is not empty
  std::string link;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // N s, world axes
};

// M; a foot that rises by this height makes the robot's first step.
inline constexpr double kFirstStep = 0.005;

// A link of a world model.
struct WorldBody {
  std::string model;
  RigidLink rigid;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // start pose in the world
  bool fixed = false;
  std::vector<Kick> kicks;  // sorted by time
};

struct WorldModel {
  Eigen::Vector3d gravity{0, 0, -9.81};
  std::vector<WorldBody> bodies;
  Light light;
  // Start pose of the robot: the origin is the point between the soles, x is forward.
  Eigen::Isometry3d robot_start = Eigen::Isometry3d::Identity();
  std::vector<Push> pushes;  // on the robot, sorted by time
  // Names of robot links. The robot's first step is when one of these links has risen by kFirstStep; times of
  // pushes count from the first step. If `feet` is empty, times of pushes count from the start.
  std::vector<std::string> feet;
};

// Loads and checks an SDF world. Errors name file and line. Never accesses the network.
Result<WorldModel> load_world(const std::string& sdf_path);

}  // namespace kaz::sim
