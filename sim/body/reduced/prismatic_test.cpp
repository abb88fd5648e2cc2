// Prismatic joints, which are driven by rack and pinion, against closed forms and conserved quantities.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/body/reduced/reduced_world.h"
#include "sim/body/world/plain_models_testing.h"

namespace kaz::sim {
namespace {

constexpr double kPinion = 0.05;  // m
constexpr double kSliderStep = 1e-3;  // s

RigidLink slider() {
  RigidLink link = test::ball("slider", 0.1, 0.02, Surface{});
  link.collisions.clear();
  return link;
}

// Appends the slider to the last link.
void add_slider(RobotModel& robot, const Eigen::Vector3d& at, const Eigen::Vector3d& axis,
                double upper) {
  test::add_link(robot, slider(), at, axis, -3, upper);
  robot.joints.back().pinion_m = kPinion;
}

// (m p^2 + J) q'' = -m g p: the rotor slows the fall down.
TEST(Prismatic, FallsWithTheRotorsInertia) {
  RobotModel robot = test::fixed_place();
  add_slider(robot, {0, 0, 1}, Eigen::Vector3d::UnitZ(), 3);
  WorldModel around;
  around.gravity = {0, 0, -9.81};
  WorldOptions options;
  options.step_s = kSliderStep;
  ReducedWorld world(around, robot, test::free_motor(), options);
  for (int i = 0; i < 300; ++i) world.step({}, 0);
  const double inertia = slider().mass * kPinion * kPinion;
  const double rate = -slider().mass * 9.81 * kPinion / (inertia + test::kFreeRotor);
  EXPECT_NEAR(world.joints()[0].velocity, rate * 0.3, 1e-9);
  // The position is integrated with the velocity at the end of each step.
  EXPECT_NEAR(world.joints()[0].angle, rate * 0.3 * (0.3 + kSliderStep) / 2, 1e-6);
  EXPECT_NEAR(world.tree().origin(1).z(), 1 + kPinion * world.joints()[0].angle, 1e-12);
}

// The stop is one degree beyond the limit.
TEST(Prismatic, StopsAtItsLimit) {
  RobotModel robot = test::fixed_place();
  add_slider(robot, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), 0.5);
  WorldModel around;
  around.gravity.setZero();
  ReducedWorld world(around, robot, test::free_motor(), {});
  const std::vector<MotorDrive> drive{{0.5, true}};
  for (int i = 0; i < 2000; ++i) world.step(drive, 8);
  EXPECT_GT(world.joints()[0].angle, 0.5);
  EXPECT_LT(world.joints()[0].angle, 0.53);
  EXPECT_NEAR(world.tree().origin(1).x(), kPinion * world.joints()[0].angle, 1e-12);
}

// A slider on a turning arm moves outward: Coriolis and centrifugal force.
TEST(Prismatic, KeepsEnergyAndAngularMomentumOnATurningArm) {
  RobotModel robot = test::fixed_place();
  RigidLink arm = test::rod("arm");
  arm.com.setZero();
  test::add_link(robot, arm, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), -1e3, 1e3);
  add_slider(robot, {0.2, 0, 0}, Eigen::Vector3d::UnitX(), 1e3);
  WorldModel around;
  around.gravity.setZero();
  WorldOptions options;
  options.step_s = 1e-4;
  ReducedWorld world(around, robot, test::free_motor(), options);
  const std::vector<MotorDrive> drive{{0.8, true}, {0, false}};
  while (world.time_s() < 0.1) world.step(drive, 8);
  const auto radius = [&] { return 0.2 + kPinion * world.joints()[1].angle; };
  const double spin = test::kRodSlim + 0.4 * slider().mass * 0.02 * 0.02 + test::kFreeRotor;
  const auto momentum = [&] {
    return (spin + slider().mass * radius() * radius()) * world.joints()[0].velocity;
  };
  const auto energy = [&] {
    const double out = world.joints()[1].velocity;
    return (momentum() * world.joints()[0].velocity +
            (slider().mass * kPinion * kPinion + test::kFreeRotor) * out * out) /
           2;
  };
  const double momentum_before = momentum(), energy_before = energy(), radius_before = radius();
  ASSERT_GT(world.joints()[0].velocity, 1);
  while (world.time_s() < 0.6) world.step({}, 0);
  EXPECT_GT(radius(), radius_before + 0.05);
  EXPECT_NEAR(momentum() / momentum_before, 1, 1e-3);
  EXPECT_NEAR(energy() / energy_before, 1, 2e-3);
}

}  // namespace
}  // namespace kaz::sim
