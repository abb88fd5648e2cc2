// The robot as its URDF describes it, in the form that the dynamics needs.
// SPDX-License-Identifier: Apache-2.0
//
// What a robot file must have: docs/reference/robot.md. Links at fixed joints are merged with the link
// that carries them; their frames remain known by name.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "sim/body/description/joint_names.h"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

struct RobotLink {
  RigidLink rigid;
  int parent = -1;  // index into RobotModel::links, always smaller than the link's own
  int joint = -1;   // joint number that moves it; -1: the root
  // Pose in the root link's frame at the zero posture.
  Eigen::Isometry3d at_zero = Eigen::Isometry3d::Identity();
};

struct RobotJoint {
  std::string name;
  int child = 0;                                    // index into RobotModel::links
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // unit, root frame at the zero posture
  double lower = 0, upper = 0;                      // rad, what the firmware allows
};

struct RobotFrame {
  int link = 0;  // index into RobotModel::links
  Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();
};

struct RobotModel {
  std::string name;
  std::vector<RobotLink> links;  // parents before children, the root first
  bool fixed_base = false;       // the root link is called `world` and never moves
  // The revolute ones: of Kaz in the order of shared/board/joints.def, else in that of the file.
  std::vector<RobotJoint> joints;
  std::map<std::string, RobotFrame> frames;  // every link of the file, welded ones included

  double mass() const;
  std::vector<std::string> joint_order() const;
  // Link that carries both eyes; -1 if there is none.
  int eyes_link() const;
  // Bounding box of the collision shapes at the zero posture, in the root link's frame.
  Eigen::AlignedBox3d extent() const;
};

// Errors name file and line.
Result<RobotModel> load_robot(const std::string& urdf_path);

}  // namespace kaz::sim
