// A clone of a world goes on exactly as the original, and neither touches the other.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

#include "sim/body/description/files_testing.h"
#include "sim/body/world/gait_testing.h"
#include "sim/body/world/plain_models_testing.h"
#include "sim/body/world/staged_world.h"

namespace kaz::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Worlds = std::vector<std::unique_ptr<World>>;

const std::string kProps = "sim/worlds/props.sdf";

std::unique_ptr<World> clone_of(const World& world) {
  auto clone = world.clone();
  EXPECT_TRUE(clone) << clone.error().message;
  return clone ? std::move(*clone) : nullptr;
}

// All that can be read of a world, bit for bit.
Bytes bytes_of(World& world) {
  StateWriter to;
  world.save(to);
  const auto add = [&to](const auto& numbers) {
    for (double number : numbers) to(number);
  };
  for (const Eigen::Isometry3d& frame : world.pose().frames) add(frame.matrix().reshaped());
  for (const ContactPoint& point : world.contacts()) {
    add(point.at);
    add(point.force);
  }
  for (const JointLoad& load : world.joint_loads()) {
    add(load.force);
    add(load.moment);
  }
  add(std::array{world.time_s(), world.supply_current_a(), world.largest_joint_gap_m()});
  return to.bytes();
}

// Kaz walks on the spot and is pushed every second.
void walk(World& world) {
  const double t = world.time_s();
  const bench::Angles targets =
      bench::walking_angles(std::clamp(t - 2.0, 0.0, 1.0), t - std::floor(t));
  test::Drives drives;
  for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
    const JointState& joint = world.joints()[i];
    const double error = std::min(1.0, t) * targets[i] - joint.angle;
    drives[i] = {std::clamp(20 * error - 0.15 * joint.velocity, -1.0, 1.0), true};
  }
  if (std::lround(t / world.step_s()) % 1000 == 400) {
    EXPECT_TRUE(world.push("trunk", {0.02, 0.01, 0}));
  }
  world.step(drives, 10.0);
}

// Two fingers that hang from a fixed place and hold a block between them.
void squeeze(World& world) {
  const double pull = 0.1 + 0.02 * std::sin(20 * world.time_s());
  const std::array<MotorDrive, 2> drives{{{-pull, true}, {pull, true}}};
  world.step(drives, 10.0);
}

std::unique_ptr<World> grasp(const WorldOptions& options) {
  constexpr double kHeight = 0.5;
  const Surface rubber{.mu = 1, .softness = 5e-3};
  RobotModel robot = test::fixed_place();
  for (const double side : {-1.0, 1.0}) {
    RigidLink finger = test::rod(side < 0 ? "left" : "right");
    finger.collisions.push_back(test::touching(Shape::Kind::box, {0.01, 0.04, 0.2}, rubber));
    finger.collisions.back().in_link.translation().z() = -test::kRodLength / 2;
    test::add_link(robot, finger, {side * 0.0246, 0, kHeight}, Eigen::Vector3d::UnitY(), -1, 1);
    robot.links.back().parent = 0;
  }
  WorldModel around = test::floor_of({.mu = 0.7}, {0, 0, -9.81});
  around.bodies.push_back(
      test::thing(test::box("block", 0.03, {0.04, 0.03, 0.03}, rubber), {0, 0, kHeight - 0.16}));
  auto world = make_world(around, robot, test::free_motor(), options);
  EXPECT_TRUE(world) << world.error().message;
  return world ? std::move(*world) : nullptr;
}

class Clone : public testing::TestWithParam<const char*> {
 protected:
  WorldOptions options() const {
    WorldOptions options;
    options.dynamics = GetParam();
    options.seed = 3;
    return options;
  }
  // Kaz amid a step, among props of which some rest, and watched.
  std::unique_ptr<World> walking() const {
    auto world = test::load_or_fail(kProps, options());
    if (!world) return nullptr;
    world->watch_contacts(true);
    world->watch_loads(true);
    while (world->time_s() < 3.2) walk(*world);
    return world;
  }
};

INSTANTIATE_TEST_SUITE_P(Dynamics, Clone, testing::Values("reduced", "exact", "quick20"));

TEST_P(Clone, GoesOnAsTheOriginalWould) {
  auto original = walking();
  ASSERT_TRUE(original);
  ASSERT_FALSE(original->contacts().empty());
  ASSERT_FALSE(original->joint_loads().empty());
  ASSERT_TRUE(original->push("trunk", {0, 0.01, 0}));  // due in the next step of both
  auto clone = clone_of(*original);
  ASSERT_TRUE(clone);
  EXPECT_TRUE(bytes_of(*clone) == bytes_of(*original));
  for (int second = 1; second <= 10; ++second) {
    for (int i = 0; i < 1000; ++i) walk(*original);
    for (int i = 0; i < 1000; ++i) walk(*clone);
    ASSERT_TRUE(bytes_of(*clone) == bytes_of(*original)) << second;
  }
  EXPECT_GT(original->link_pose("trunk").linear()(2, 2), 0.8) << "it must still stand";
}

TEST_P(Clone, HoldsWhatTheOriginalHolds) {
  auto original = grasp(options());
  ASSERT_TRUE(original);
  for (int i = 0; i < 500; ++i) squeeze(*original);
  auto clone = clone_of(*original);
  ASSERT_TRUE(clone);
  for (int second = 1; second <= 10; ++second) {
    for (int i = 0; i < 1000; ++i) squeeze(*original);
    for (int i = 0; i < 1000; ++i) squeeze(*clone);
    ASSERT_TRUE(bytes_of(*clone) == bytes_of(*original)) << second;
  }
  EXPECT_NEAR(clone->object_position("block")->z(), 0.34, 0.01) << "the block must be held";
}

TEST_P(Clone, OutlivesTheOriginalAndLeavesItAlone) {
  auto original = walking();
  ASSERT_TRUE(original);
  auto undisturbed = clone_of(*original), fallen = clone_of(*original);
  ASSERT_TRUE(undisturbed && fallen);
  for (int i = 0; i < 500; ++i) {
    fallen->step({}, 10.0);
    walk(*original);
  }
  const Bytes expected = bytes_of(*original);
  EXPECT_FALSE(bytes_of(*fallen) == expected);
  original.reset();
  fallen.reset();
  for (int i = 0; i < 500; ++i) walk(*undisturbed);
  EXPECT_TRUE(bytes_of(*undisturbed) == expected);
  auto again = clone_of(*clone_of(*undisturbed));
  EXPECT_TRUE(bytes_of(*again) == expected);
}

// Worlds that step in one thread share its working memory.
TEST_P(Clone, TakesTurnsWithOtherWorlds) {
  auto among_props = walking();
  auto holding = grasp(options());
  ASSERT_TRUE(among_props && holding);
  auto alone = clone_of(*among_props);
  auto held_alone = clone_of(*holding);
  auto empty = test::load_or_fail(test::kEmpty, options());
  ASSERT_TRUE(alone && held_alone && empty);
  for (int i = 0; i < 600; ++i) walk(*alone);
  for (int i = 0; i < 600; ++i) squeeze(*held_alone);
  for (int i = 0; i < 600; ++i) {
    walk(*among_props);
    squeeze(*holding);
    walk(*empty);
  }
  EXPECT_TRUE(bytes_of(*among_props) == bytes_of(*alone));
  EXPECT_TRUE(bytes_of(*holding) == bytes_of(*held_alone));
}

TEST_P(Clone, StepsInAThreadOfItsOwn) {
  auto original = walking();
  ASSERT_TRUE(original);
  Worlds clones;
  for (int i = 0; i < 4; ++i) clones.push_back(clone_of(*original));
  const auto run = [&clones](std::size_t first) {
    for (int i = 0; i < 1000; ++i) {
      walk(*clones[first]);
      walk(*clones[first + 2]);
    }
  };
  std::thread one(run, 0), other(run, 1);
  for (int i = 0; i < 1000; ++i) walk(*original);
  one.join();
  other.join();
  const Bytes expected = bytes_of(*original);
  for (const auto& clone : clones) EXPECT_TRUE(bytes_of(*clone) == expected);
}

TEST_P(Clone, KeepsWhatIsStillToCome) {
  // props.sdf flicks its ball again and again: kicks lie behind and ahead. The robot is no part of this.
  auto loaded = World::load(kProps, "sim/robots/arm/arm.urdf", options());
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto original = std::move(*loaded);
  test::run(*original, 1.0);
  auto clone = clone_of(*original);
  ASSERT_TRUE(clone);
  const Eigen::Vector3d before = *clone->object_position("ball");
  test::run(*original, 5.0);
  test::run(*clone, 5.0);
  EXPECT_TRUE(bytes_of(*clone) == bytes_of(*original));
  EXPECT_GT((*clone->object_position("ball") - before).norm(), 0.01);
}

TEST_P(Clone, OfABrokenWorldIsBroken) {
  auto original = test::load_or_fail(test::kEmpty, options());
  ASSERT_TRUE(original);
  ASSERT_TRUE(original->push("trunk", {1e6, 0, 0}));
  original->step({}, 10);
  ASSERT_FALSE(original->diagnostics().failure.empty());
  auto clone = clone_of(*original);
  ASSERT_TRUE(clone);
  EXPECT_EQ(clone->diagnostics().failure, original->diagnostics().failure);
  EXPECT_EQ(clone->time_s(), original->time_s());
}

}  // namespace
}  // namespace kaz::sim
