// A robot that is not Kaz is data: an arm on a fixed base, with six joints.
// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <cstdio>
#include <sstream>

#include "shared/base/angle.hpp"
#include "sim/body/description/files_testing.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {
namespace {

const std::string kArm = "sim/robots/arm/arm.urdf";

std::unique_ptr<World> arm(const WorldOptions& options = {}) {
  auto world = World::load(test::kEmpty, kArm, options);
  if (!world) {
    ADD_FAILURE() << world.error().message;
    return nullptr;
  }
  return std::move(*world);
}

TEST(Arm, HasItsJointsInTheOrderOfItsFile) {
  const auto world = arm();
  ASSERT_TRUE(world);
  const std::vector<std::string> names(world->joint_order().begin(), world->joint_order().end());
  // Neither alphabetical nor that of the servo board.
  EXPECT_EQ(names, (std::vector<std::string>{"turn", "shoulder", "elbow", "roll", "wrist", "jaw"}));
  EXPECT_EQ(world->joints().size(), 6u);
  EXPECT_EQ(world->head_frame(), -1) << "it has no eyes";
}

TEST(Arm, StandsWhereTheWorldPutsIt) {
  const auto world = arm();
  ASSERT_TRUE(world);
  const std::vector<MotorDrive> off(6);
  for (int i = 0; i < 500; ++i) world->step(off, 10.0);
  EXPECT_TRUE(world->link_pose("base").isApprox(Eigen::Isometry3d::Identity(), 1e-12));
  // Motors off: friction (0.128 Nm) holds the balanced arm up.
  EXPECT_NEAR(world->link_pose("wrist").translation().z(), 0.315, 1e-3);
}

TEST(Arm, FollowsItsMotors) {
  for (const char* dynamics : {"quick50", "exact", "reduced"}) {
    WorldOptions options;
    options.dynamics = dynamics;
    const auto world = arm(options);
    ASSERT_TRUE(world);
    const double target[6] = {0.8, 0.9, -1.2, 0.5, -1.0, -0.5};
    std::vector<MotorDrive> drives(6);
    for (int i = 0; i < 1500; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        const JointState& joint = world->joints()[j];
        drives[j] = {std::clamp(20 * (target[j] - joint.angle) - 0.15 * joint.velocity, -1.0, 1.0),
                     true};
      }
      world->step(drives, 10.0);
    }
    // Stiction of 0.166 Nm at 43 Nm/rad leaves at most 3.9 mrad, gravity of 0.5 Nm 12 mrad.
    for (std::size_t j = 0; j < 6; ++j) {
      EXPECT_NEAR(world->joints()[j].angle, target[j], 0.017) << dynamics << j;
    }
    EXPECT_LT(world->largest_joint_gap_m(), 1e-4);
  }
}

TEST(Arm, LeavesMotorsWithoutADriveOpen) {
  const auto world = arm();
  ASSERT_TRUE(world);
  const std::vector<MotorDrive> one{{0.5, true}};
  for (int i = 0; i < 100; ++i) world->step(one, 10.0);
  EXPECT_GT(world->joints()[0].angle, 0.2);
  EXPECT_NEAR(world->joints()[1].angle, 0, 0.02);
}

TEST(Arm, KeepsItsLimitsInsideTheBoardsChannels) {
  const auto robot = load_robot(kArm), kaz = load_robot(test::kRobot);
  ASSERT_TRUE(robot && kaz);
  for (std::size_t j = 0; j < robot->joints.size(); ++j) {
    EXPECT_GE(robot->joints[j].lower, kaz->joints[j].lower) << robot->joints[j].name;
    EXPECT_LE(robot->joints[j].upper, kaz->joints[j].upper) << robot->joints[j].name;
  }
}

// Returns the row of docs/reference/robot.md for a joint, such as "2, 6    l_, r_sh_pitch ...", or "".
std::string documented_row(std::size_t joint) {
  std::istringstream lines(test::read_text("docs/reference/robot.md"));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    for (std::string word; words >> word && std::isdigit(static_cast<unsigned char>(word[0]));) {
      if (std::stoul(word) == joint && line.find("..") != std::string::npos) return line;
    }
  }
  return "";
}

// Authors of other robots choose the channels by this table.
TEST(Channel, LimitsAreThoseOfTheDocumentation) {
  const auto kaz = load_robot(test::kRobot);
  ASSERT_TRUE(kaz);
  for (std::size_t j = 0; j < kaz->joints.size(); ++j) {
    const RobotJoint& joint = kaz->joints[j];
    char limits[48];
    std::snprintf(limits, sizeof limits, " %.0f..%.0f ", joint.lower / kDegree,
                  joint.upper / kDegree);
    EXPECT_NE(documented_row(j).find(limits), std::string::npos)
        << joint.name << limits << ": `" << documented_row(j) << "`";
  }
}

}  // namespace
}  // namespace kaz::sim
