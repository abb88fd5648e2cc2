// Poses of a robot with a joint that follows another joint.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/joint_poses.h"

#include <array>

#include <gtest/gtest.h>

#include "sim/body/world/plain_models_testing.h"

namespace kaz::viewer {
namespace {

TEST(JointPoses, FollowersTurnWithTheirLeaders) {
  sim::RobotModel robot = sim::test::chain(2, false);
  robot.joints[1].follows = sim::JointCoupling{0, -2, 0.3};
  const JointPoses poses(robot, true);
  std::array<double, KZ_JOINTS> angles{};
  angles[0] = 0.5;
  angles[1] = 9;  // of no joint with a motor
  for (const auto& [name, pose] : poses.at(angles)) {
    if (name != "rod1") continue;
    const double turn = 0.5 + (-2 * 0.5 + 0.3);  // both joints turn about y
    EXPECT_TRUE(pose.linear().isApprox(
        Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix(), 1e-12));
    return;
  }
  FAIL() << "rod1 has no pose";
}

}  // namespace
}  // namespace kaz::viewer
