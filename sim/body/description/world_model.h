// The robot's environment, loaded from an SDF world. Supported subset: docs/reference/worlds.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// Velocity change of an object at a given time.
struct Kick {
  double time_s = 0;
  // At the time `time_s`, the vector `velocity` is added to the object's velocity. Unit m/s, world axes.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

// Impulse on a link of the robot, at the link's center of mass.
struct Push {
  // Time of the impulse. If WorldModel::feet is empty, the time counts from the start. Otherwise, the time
  // counts from the robot's first step.
  double time_s = 0;
  std::string link;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // N s, world axes
};

// Height in m by which a foot must rise to count as the robot's first step.
inline constexpr double kFirstStep = 0.005;

// A link of a world model.
struct WorldBody {
  std::string model;
  RigidLink rigid;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // start pose in the world
  bool fixed = false;
  std::vector<Kick> kicks;  // sorted by time
};

// Passive joint between two bodies of the world. Poses are those at the start.
struct WorldJoint {
  enum class Kind { revolute, prismatic, ball };
  std::string name;  // "model/joint"
  Kind kind = Kind::revolute;
  int parent = -1;  // index into WorldModel::bodies; -1: the world
  int child = 0;    // index into WorldModel::bodies
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  // world frame, m; not used by prismatic joints
  // Unit vector in world axes. A positive angle turns the child about this axis relative to the parent. Not
  // used by ball joints.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  // Stops relative to the start, rad or m; infinite without limits.
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double damping = 0;   // Nm s/rad or N s/m
  double friction = 0;  // Coulomb friction, Nm or N
};

struct WorldModel {
  Eigen::Vector3d gravity{0, 0, -9.81};
  std::vector<WorldBody> bodies;
  std::vector<WorldJoint> joints;
  std::vector<FileNote> notes;  // elements of the file that are not used
  Light light;
  // Pose of the robot at the start. The origin of this pose is the point between the soles; the x axis points
  // forward.
  Eigen::Isometry3d robot_start = Eigen::Isometry3d::Identity();
  std::vector<Push> pushes;  // pushes on the robot, sorted by time
  // Names of the robot links that count as feet. The robot takes the first step at the moment when one of
  // these links has risen by kFirstStep. Push::time_s counts from this moment. If `feet` is empty,
  // Push::time_s counts from the start.
  std::vector<std::string> feet;
};

// Loads and checks an SDF world. An error message names file and line. The function never accesses the
// network.
Result<WorldModel> load_world(const std::string& sdf_path, const ReadOptions& options = {});

}  // namespace kaz::sim
