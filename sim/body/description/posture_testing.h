// For judges of robot files: poses of links by forward kinematics, and units of joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/body/description/robot_model.h"

namespace kaz::sim::test {

// Returns the poses of the moving links in the root's frame. `angles` are in rad, in the order of the joints.
inline std::vector<Eigen::Isometry3d> link_poses(const RobotModel& robot,
                                                 const std::vector<double>& angles) {
  std::vector<Eigen::Isometry3d> poses;
  for (const RobotLink& link : robot.links) {
    if (link.parent < 0) {
      poses.push_back(link.at_zero);
      continue;
    }
    const auto parent = static_cast<std::size_t>(link.parent),
               joint = static_cast<std::size_t>(link.joint);
    const Eigen::Vector3d axis = link.at_zero.linear().transpose() * robot.joints[joint].axis;
    poses.push_back(poses[parent] * robot.links[parent].at_zero.inverse() * link.at_zero *
                    joint_motion(robot.joints[joint], axis, angles[joint]));
  }
  return poses;
}

// Returns the factor from rad to the unit of the file, which is m for a prismatic joint.
inline double unit_of(const RobotJoint& joint) {
  return joint.pinion_m > 0 ? joint.pinion_m : 1;
}

}  // namespace kaz::sim::test
