// Poses of a robot's frames, computed from the joint angles alone. The true position of the trunk is unknown.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "shared/board/board.h"
#include "sim/body/description/robot_model.h"
#include "sim/runtime/formats/ros_messages.h"

namespace kaz::viewer {

class JointPoses {
 public:
  // `hangs`: true: the robot hangs in the air, with its root at the origin. False: the robot stands on its
  // lower foot, which is level.
  JointPoses(sim::RobotModel model, bool hangs) : model_(std::move(model)), hangs_(hangs) {}

  const sim::RobotModel& model() const { return model_; }
  // Returns the poses of all frames in the world. `angles` in rad.
  std::vector<sim::ros::NamedPose> at(std::span<const double, KZ_JOINTS> angles) const;

 private:
  Eigen::Isometry3d standing(const std::vector<Eigen::Isometry3d>& links) const;

  sim::RobotModel model_;
  bool hangs_;
};

}  // namespace kaz::viewer
