// Joints that follow another joint, against closed forms: period, angles at an obstacle, momentum, state.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "shared/base/archive.hpp"
#include "sim/body/description/files_testing.h"
#include "sim/body/reduced/reduced_world.h"
#include "sim/body/world/plain_models_testing.h"

namespace kaz::sim {
namespace {

constexpr double kRatio = -2, kOffset = 0.3;
constexpr double kCoupledStep = 1e-3;  // s

// Appends a rod on the root. `shapes`: whether its end is a ball that collides.
void hang_rod(RobotModel& robot, double at_x, bool shapes) {
  RobotLink link;
  link.rigid = test::rod(std::string("arm").append(std::to_string(robot.links.size())));
  if (shapes) {
    CollisionShape end = test::touching(Shape::Kind::sphere, {0.01, 0, 0}, Surface{});
    end.in_link.translation().z() = -test::kRodLength;
    link.rigid.collisions.push_back(end);
  }
  link.at_zero.translation().x() = at_x;
  link.parent = 0;
  link.joint = static_cast<int>(robot.joints.size());
  robot.joints.push_back({std::string("j").append(std::to_string(link.joint)),
                          static_cast<int>(robot.links.size()), Eigen::Vector3d::UnitY(), -3, 3});
  robot.frames[link.rigid.name] = {static_cast<int>(robot.links.size()),
                                   Eigen::Isometry3d::Identity()};
  robot.links.push_back(link);
}

// Two rods side by side; the second follows the first.
RobotModel coupled_rods(RobotModel robot, double offset, bool shapes = false) {
  hang_rod(robot, 0, shapes);
  hang_rod(robot, 1, shapes);
  robot.joints[1].follows = JointCoupling{0, kRatio, offset};
  return robot;
}

RobotModel coupled_rods(double offset = 0, bool shapes = false) {
  return coupled_rods(test::fixed_place(), offset, shapes);
}

double coupling_error(const ReducedWorld& world, double offset) {
  return std::abs(world.tree().angle[1] - kRatio * world.tree().angle[0] - offset);
}

// Sloping gravity moves the equilibrium, about which the rods swing:
// (I (1 + r^2) + J) q'' = -m g l / 2 (1 + r^2) q.
TEST(Coupling, SwingsWithThePeriodOfBothRods) {
  constexpr double kSlope = 0.01, kShare = 1 + kRatio * kRatio;
  WorldModel around;
  around.gravity = 9.81 * Eigen::Vector3d(std::sin(kSlope), 0, -std::cos(kSlope));
  WorldOptions options;
  options.step_s = kCoupledStep;
  ReducedWorld world(around, coupled_rods(), test::free_motor(), options);
  const double arm = test::kRodLength / 2;
  const double inertia =
      kShare * (test::kRodInertia + test::kRodMass * arm * arm) + test::kFreeRotor;
  const double period =
      2 * std::numbers::pi * std::sqrt(inertia / (kShare * test::kRodMass * 9.81 * arm));
  const auto speed = [&] { return world.joints()[0].velocity; };
  std::vector<double> turns;
  for (double before = 0; turns.size() < 21; before = speed()) {
    world.step({}, 0);
    ASSERT_LT(coupling_error(world, 0), 1e-9);
    if (before > 0 && speed() <= 0)
      turns.push_back(world.time_s() - kCoupledStep * speed() / (speed() - before));
    ASSERT_LT(world.time_s(), 60);
  }
  EXPECT_NEAR((turns.back() - turns.front()) / 20 / period, 1, 1e-4);
  EXPECT_EQ(world.diagnostics().unconverged_steps, 0);
}

// The motor presses the follower against an obstacle: the coupling holds, and the leader stops, too.
TEST(Coupling, HoldsAtAnObstacle) {
  WorldModel around;
  around.gravity.setZero();
  RigidLink wall = test::box("wall", 1, {0.02, 0.2, 0.2}, Surface{});
  WorldBody fixed = test::thing(wall, {1.13, 0, -0.2});
  fixed.fixed = true;
  around.bodies.push_back(fixed);
  ReducedWorld world(around, coupled_rods(kOffset, true), test::free_motor(), {});
  EXPECT_EQ(world.tree().angle[1], kOffset);
  world.watch_contacts(true);
  const std::vector<MotorDrive> drive{{0.5, true}};
  bool touched = false;
  for (int i = 0; i < 1000; ++i) {
    world.step(drive, 8);
    ASSERT_LT(coupling_error(world, kOffset), 1e-6) << world.time_s();
    touched = touched || !world.contacts().empty();
  }
  EXPECT_TRUE(touched);
  EXPECT_LT(std::abs(world.joints()[0].velocity), 1e-3);
  EXPECT_LT(std::abs(world.joints()[0].angle), 1);
  EXPECT_GT(std::abs(world.joints()[0].torque), 0.5);
  EXPECT_EQ(world.joints().size(), 1u);
  EXPECT_EQ(world.diagnostics().unconverged_steps, 0);
}

// The impulses of a coupling are inner ones.
TEST(Coupling, KeepsMomentumInFlight) {
  WorldModel space;
  space.gravity.setZero();
  RigidLink trunk = test::box("trunk", 0.5, {0.1, 0.1, 0.1}, Surface{});
  trunk.collisions.clear();
  ReducedWorld world(space, coupled_rods(test::lone(trunk), kOffset), test::free_motor(), {});
  for (int i = 0; i < 500; ++i) {
    const std::vector<MotorDrive> drive{{std::sin(0.02 * i), true}};
    world.step(drive, 8);
    ArticulatedTree tree = world.tree();
    ASSERT_LT(tree.momentum().angular.norm(), 1e-12);
    ASSERT_LT(tree.momentum().linear.norm(), 1e-12);
    ASSERT_LT(coupling_error(world, kOffset), 1e-6);
  }
  EXPECT_GT(std::abs(world.joints()[0].angle), 0.05);
}

TEST(Coupling, ContinuesFromCloneAndSavedState) {
  WorldModel around;
  ReducedWorld world(around, coupled_rods(kOffset), test::free_motor(), {});
  const std::vector<MotorDrive> drive{{0.3, true}};
  for (int i = 0; i < 200; ++i) world.step(drive, 8);
  const auto clone = *world.clone();
  StateWriter saved;
  world.save(saved);
  ReducedWorld restored(around, coupled_rods(kOffset), test::free_motor(), {});
  StateReader reader(saved.bytes());
  restored.restore(reader);
  ASSERT_TRUE(reader.good());
  for (int i = 0; i < 200; ++i) {
    world.step(drive, 8);
    clone->step(drive, 8);
    restored.step(drive, 8);
  }
  for (const World* other : {clone.get(), static_cast<World*>(&restored)}) {
    EXPECT_EQ(other->joints()[0].angle, world.joints()[0].angle);
    EXPECT_EQ(other->joints()[0].velocity, world.joints()[0].velocity);
    EXPECT_EQ(other->link_pose("arm2").matrix(), world.link_pose("arm2").matrix());
  }
}

// Friction and damping of a follower act through the coupling, so the leader slows down faster.
TEST(Coupling, FollowersBrakeTheirLeader) {
  WorldModel space;
  space.gravity.setZero();
  const auto speed_after = [&](double friction, double damping) {
    RobotModel robot = coupled_rods();
    robot.joints[1].friction = friction;
    robot.joints[1].damping = damping;
    ReducedWorld world(space, robot, test::free_motor(), {});
    for (int i = 0; i < 200; ++i) world.step(std::vector<MotorDrive>{{0.3, true}}, 8);
    return world.joints()[0].velocity;
  };
  const double free = speed_after(0, 0);
  EXPECT_LT(speed_after(0.05, 0), 0.9 * free);
  EXPECT_LT(speed_after(0, 0.02), 0.9 * free);
  EXPECT_EQ(speed_after(10, 0), 0);
}

TEST(Coupling, NeedsReducedDynamics) {
  WorldOptions options;
  options.dynamics = "exact";
  const auto world = make_world(WorldModel{}, coupled_rods(), test::free_motor(), options);
  ASSERT_FALSE(world);
  EXPECT_EQ(world.error().message,
            "joint `j1` follows joint `j0`, which only --dynamics reduced supports; leave out "
            "--dynamics");
}

}  // namespace
}  // namespace kaz::sim
