// The whole robot against school mechanics: momentum; and what it may touch of itself.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <thread>

#include "shared/base/angle.hpp"
#include "sim/body/description/files_testing.h"
#include "sim/body/world/plain_models_testing.h"
#include "sim/body/world/staged_world.h"

namespace kaz::sim {
namespace {

constexpr double kStep = 1e-3;

class Robot : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    auto robot = load_robot(test::kRobot);
    auto motor = load_motor_file("shared/robot/kaz/motor.xml", "");
    ASSERT_TRUE(robot && motor);
    robot_ = *robot;
    motor_ = *motor;
  }
  std::unique_ptr<StagedWorld> world(const WorldModel& around, bool hung = false) {
    WorldOptions options;
    options.hung = hung;
    options.dynamics = GetParam();
    return std::move(*make_world(around, robot_, motor_, options));
  }
  Eigen::Vector3d centre_of_mass(const World& world) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const RobotLink& link : robot_.links)
      sum += link.rigid.mass * (world.link_pose(link.rigid.name) * link.rigid.com);
    return sum / robot_.mass();
  }
  std::vector<Eigen::Isometry3d> poses(const World& world) const {
    std::vector<Eigen::Isometry3d> poses;
    for (const RobotLink& link : robot_.links) poses.push_back(world.link_pose(link.rigid.name));
    return poses;
  }
  // About a point, by differences over a step; and the sum of the links' sizes.
  std::pair<Eigen::Vector3d, double> angular_momentum(const std::vector<Eigen::Isometry3d>& before,
                                                      const std::vector<Eigen::Isometry3d>& now,
                                                      const Eigen::Vector3d& about) const {
    Eigen::Vector3d angular = Eigen::Vector3d::Zero();
    double parts = 0;
    for (std::size_t k = 0; k < robot_.links.size(); ++k) {
      const RigidLink& link = robot_.links[k].rigid;
      const Eigen::Vector3d at = now[k] * link.com, was = before[k] * link.com;
      const Eigen::AngleAxisd turn(now[k].linear() * before[k].linear().transpose());
      const Eigen::Matrix3d inertia = now[k].linear() * link.inertia * now[k].linear().transpose();
      const Eigen::Vector3d own = link.mass * (at - about).cross((at - was) / kStep) +
                                  inertia * (turn.axis() * turn.angle() / kStep);
      angular += own;
      parts += own.norm();
    }
    return {angular, parts};
  }
  RobotModel robot_;
  MotorParams motor_;
};

INSTANTIATE_TEST_SUITE_P(Dynamics, Robot, testing::Values("quick50", "exact", "reduced"));

// In free flight a push gives all of its impulse, and its moment about the centre of mass, by differences
// over a step: positions are of order 1 m and move by 1e-4 m, which leaves 1e-12; the rest is that the
// step's velocities are those of its places to (w h)^2.
TEST_P(Robot, GainsThePushThatItGets) {
  WorldModel space;
  space.gravity.setZero();
  for (const char* name : {"trunk", "l_ankle_pitch"}) {
    const auto flying = world(space);
    const std::vector<MotorDrive> open(KZ_JOINTS);
    for (int i = 0; i < 20; ++i) flying->step(open, 10.0);
    const Eigen::Vector3d impulse(0.03, -0.02, 0.015);
    ASSERT_TRUE(flying->push(name, impulse));
    const auto link = std::ranges::find(robot_.links, std::string(name),
                                        [](const RobotLink& l) { return l.rigid.name; });
    const Eigen::Vector3d arm = flying->link_pose(name) * link->rigid.com - centre_of_mass(*flying);
    const Eigen::Vector3d before = centre_of_mass(*flying);
    flying->step(open, 10.0);
    const Eigen::Vector3d middle = centre_of_mass(*flying);
    EXPECT_LT((robot_.mass() * (middle - before) / kStep - impulse).norm(), 1e-3 * impulse.norm())
        << name;
    // And it was one step's push only.
    for (int i = 0; i < 10; ++i) flying->step(open, 10.0);
    const Eigen::Vector3d since = (centre_of_mass(*flying) - middle) / (10 * kStep);
    EXPECT_LT((robot_.mass() * since - impulse).norm(), 1e-3 * impulse.norm()) << name;
    const auto was = poses(*flying);
    flying->step(open, 10.0);
    const auto [angular, of_parts] = angular_momentum(was, poses(*flying), centre_of_mass(*flying));
    EXPECT_LT((angular - arm.cross(impulse)).norm(), 0.02 * arm.cross(impulse).norm()) << name;
  }
}

TEST_P(Robot, RefusesPushesOnWhatDoesNotMove) {
  const auto hanging = world(WorldModel{}, true);
  EXPECT_FALSE(hanging->push("trunk", {0.1, 0, 0}));
  EXPECT_FALSE(hanging->push("tail", {0.1, 0, 0}));
  EXPECT_FALSE(hanging->push("l_hand", {std::nan(""), 0, 0}));
  EXPECT_TRUE(hanging->push("l_hand", {0.001, 0, 0}));
}

TEST_P(Robot, KeepsItsMomentumInFreeFlight) {
  WorldModel space;
  space.gravity.setZero();
  const auto flying = world(space);
  const Eigen::Vector3d start = centre_of_mass(*flying);
  double worst = 0, of_parts = 0;
  std::array<MotorDrive, KZ_JOINTS> drives{};
  for (int i = 0; i < 1000; ++i) {
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      const double target = 0.4 * std::sin(6 * flying->time_s() + static_cast<double>(j));
      const JointState& joint = flying->joints()[j];
      drives[j] = {std::clamp(10 * (target - joint.angle) - 0.15 * joint.velocity, -1.0, 1.0),
                   true};
    }
    const auto before = poses(*flying);
    flying->step(drives, 10.0);
    const auto [angular, parts] = angular_momentum(before, poses(*flying), Eigen::Vector3d::Zero());
    worst = std::max(worst, angular.norm());
    of_parts = std::max(of_parts, parts);
  }
  // Forces between links are equal and opposite in every solver: only rounding moves the centre.
  EXPECT_LT((centre_of_mass(*flying) - start).norm(), 1e-9);
  EXPECT_GT(of_parts, 0.005) << "it must really move";
  // Gyroscopic terms and arms are taken at the start of a step: a first-order error, w h = 1.2 % at
  // the motors' 12 rad/s.
  EXPECT_LT(worst, 0.02 * of_parts);
}

TEST_P(Robot, GivesAnObjectTheSpinOfAPush) {
  WorldModel space;
  space.gravity.setZero();
  space.bodies.push_back(
      test::thing(test::box("cube", 0.1, Eigen::Vector3d::Constant(0.05), {}), {0, 0, 2}));
  const auto made = world(space);
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 3).normalized();
  ASSERT_TRUE(made->accelerate("cube", {0.1, 0, 0}, 5 * axis));
  for (int i = 0; i < 100; ++i) made->step({}, 10);
  const Eigen::Isometry3d pose = made->pose().frames.back();
  EXPECT_TRUE(pose.linear().isApprox(Eigen::AngleAxisd(0.5, axis).toRotationMatrix(), 1e-6));
  EXPECT_NEAR(pose.translation().x(), 0.01, 1e-9);
  EXPECT_FALSE(made->accelerate("cube", {0, 0, 0}, Eigen::Vector3d::Constant(NAN)));
}

// Two at a time step as one alone does.
TEST_P(Robot, StepsInTwoThreads) {
  const auto around = load_world(test::kEmpty);
  ASSERT_TRUE(around);
  std::array<Eigen::Isometry3d, 3> trunks;
  const auto stand = [&](std::size_t number) {
    const auto standing = world(*around);
    std::array<MotorDrive, KZ_JOINTS> drives{};
    while (standing->time_s() < 0.4) {
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        const JointState& joint = standing->joints()[j];
        drives[j] = {-20 * joint.angle - 0.15 * joint.velocity, true};
      }
      standing->step(drives, 10.0);
    }
    trunks[number] = standing->link_pose("trunk");
  };
  stand(0);
  std::thread one([&] { stand(1); }), two([&] { stand(2); });
  one.join();
  two.join();
  EXPECT_TRUE(trunks[1].matrix() == trunks[0].matrix());
  EXPECT_TRUE(trunks[2].matrix() == trunks[0].matrix());
}

TEST_P(Robot, TouchesItselfInNoOrdinaryPosture) {
  WorldModel space;
  space.gravity.setZero();
  // Degrees, numbers of joints.def: straight, the walking crouch, the bend to a ball at its toes.
  const double postures[][KZ_JOINTS] = {
      {},
      {0, 0, 10, 12, -40, 0, 10, -12, -40, 0, 0, -30.8, 55.6, -27.8, 0, -30.8, 55.6, -27.8},
      {0, 0, 40, 12, 0, 0, -58.4, 13.3, -13.5, 0, 0, -115.1, 101, -35.9, 0, -115.1, 101, -35.9}};
  for (const auto& posture : postures) {
    const auto suspended = world(space, true);
    std::array<MotorDrive, KZ_JOINTS> drives{};
    // Arms turn inwards last, when they are clear of the legs.
    while (suspended->time_s() < 2.5) {
      const double time = suspended->time_s();
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        const JointState& joint = suspended->joints()[j];
        const bool roll = j == 3 || j == 7;
        const double target = std::clamp(roll ? time - 1 : time, 0.0, 1.0) * posture[j] * kDegree;
        drives[j] = {20 * (target - joint.angle) - 0.15 * joint.velocity, true};
      }
      suspended->step(drives, 10.0);
      ASSERT_EQ(suspended->find_contacts(), 0) << time << " s, posture " << (&posture - postures);
    }
  }
}

}  // namespace
}  // namespace kaz::sim
