// What an inertial sensor in the trunk feels: at rest, falling, leaning, turning.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "shared/base/angle.hpp"
#include "sim/body/description/files_testing.h"

namespace kaz::sim {
namespace {

using test::Drives;
using test::run;

std::unique_ptr<World> world_with_gravity(const std::string& gravity, bool hung) {
  const test::Folder folder;
  WorldOptions options;
  options.dynamics = "exact";
  options.hung = hung;
  return test::load_or_fail(folder.write("world.sdf", test::world_text(gravity, "")), options);
}

TEST(ImuState, StandingItFeelsTheFloorPushUpwards) {
  const auto world = world_with_gravity("0 0 -9.81", false);
  ASSERT_TRUE(world);
  EXPECT_TRUE(world->imu().specific_force.isApprox(Eigen::Vector3d(0, 0, 9.81)));
  run(*world, 1.0);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int i = 0; i < 200; ++i) {
    world->step(Drives{}, 10);
    mean += world->imu().specific_force / 200;
  }
  // It stands upright within 0.7 degrees (gaps of hip, knee and ankle): at most 0.12 m/s^2 forward. The
  // hip's roll has a gap as well, 0.2 degrees, and the sole: 0.09 m/s^2 sideways.
  EXPECT_NEAR(mean.z(), 9.81, 0.01);
  EXPECT_NEAR(mean.x(), 0, 0.12);
  EXPECT_NEAR(mean.y(), 0, 0.09);
  EXPECT_LT(world->imu().angular_velocity.norm(), 0.01);
}

TEST(ImuState, LeaningItFeelsItsShareOfGravity) {
  // Gravity turned in the world instead of the robot: it leans forward by 20 degrees and to its left
  // not at all. Hung by the trunk, so that nothing moves.
  const auto world = world_with_gravity("3.35522 0 -9.21839", true);
  ASSERT_TRUE(world);
  run(*world, 0.5);
  const Eigen::Vector3d force = world->imu().specific_force;
  // The arms may still swing a little on their friction.
  EXPECT_NEAR(force.x(), -9.81 * std::sin(20 * kDegree), 0.02);
  EXPECT_NEAR(force.y(), 0, 0.02);
  EXPECT_NEAR(force.z(), 9.81 * std::cos(20 * kDegree), 0.02);
}

TEST(ImuState, FallingItFeelsNothing) {
  const test::Folder folder;
  std::string text = test::world_text("0 0 -9.81", "");
  const std::string start = "0 -3 0 0 0 0";
  text.replace(text.find(start), start.size(), "0 -3 1 0 0 0");
  const auto world = test::load_or_fail(folder.write("world.sdf", text), {});
  ASSERT_TRUE(world);
  run(*world, 0.3);  // 0.44 m
  EXPECT_LT(world->imu().specific_force.norm(), 1e-6);
}

// Against the poses alone, which know nothing of velocities.
TEST(ImuState, AgreesWithTheSecondDifferenceOfItsPlace) {
  const auto world = world_with_gravity("0 0 0", false);
  ASSERT_TRUE(world);
  Drives drives{};
  drives[0] = {0.8, true};   // neck_pan: the trunk turns the other way
  drives[3] = {0.7, true};   // l_sh_roll
  drives[12] = {0.6, true};  // l_knee
  const double h = world->step_s();
  Eigen::Isometry3d before = world->link_pose("imu"), now = before;
  double fastest_yaw = 0, strongest = 0;
  for (int i = 0; i < 60; ++i) {
    world->step(drives, 10);
    const Eigen::Isometry3d next = world->link_pose("imu");
    if (i > 0) {
      const Eigen::AngleAxisd turn(now.linear().transpose() * next.linear());
      const Eigen::Vector3d rate = turn.angle() / h * turn.axis();
      // Turning by up to 1e-3 rad a step, axes of the step's start and end differ by that much.
      EXPECT_LT((rate - world->imu().angular_velocity).norm(), 0.002 * rate.norm() + 1e-6);
      const Eigen::Vector3d acceleration =
          next.linear().transpose() *
          (next.translation() - 2 * now.translation() + before.translation()) / (h * h);
      const Eigen::Vector3d force = world->imu().specific_force;
      // Difference quotients are late by half a step: the place turns about the centre of mass by
      // omega^2 r h / 2 meanwhile, and torques change from step to step.
      EXPECT_LT((acceleration - force).norm(), 0.02 * force.norm() + 0.05) << i;
      fastest_yaw = std::max(fastest_yaw, std::abs(rate.z()));
      strongest = std::max(strongest, force.norm());
    }
    before = now;
    now = next;
  }
  EXPECT_GT(fastest_yaw, 0.1);
  EXPECT_GT(strongest, 1.0);
}

}  // namespace
}  // namespace kaz::sim
