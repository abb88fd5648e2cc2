// A few episodes of the known gait through host, wire and emulated firmware: walking, turning, picking up.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/gait/gait.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "sim/body/description/robot_model.h"
#include "sim/body/world/world.h"
#include "tests/studies/gait/episode.h"
#include "tests/studies/gait/report.h"

namespace kaz::gait {
namespace {

const Task& task(const std::string& name) {
  for (const Task& one : tasks())
    if (one.name == name) return one;
  ADD_FAILURE() << "no task " << name;
  return tasks().front();
}

Outcome run(const std::string& name, std::uint64_t seed) {
  Setting setting;
  setting.image_path = KAZ_FIRMWARE_IMAGE;
  setting.robot_folder = KAZ_ROBOT;
  const auto outcome = run_episode(task(name), setting, seed);
  EXPECT_TRUE(outcome) << outcome.error().message;
  const Outcome out = outcome.value_or(Outcome{});
  std::printf("%s, seed %d: %.2f m in %.1f s, heading %.2f deg\n", name.c_str(),
              static_cast<int>(seed), out.forward_m, out.seconds, out.heading_deg);
  return out;
}

// Targets at 50 Hz change by less than the motors' no-load speed, 12 rad/s. Starts and ends in the crouch.
TEST(Gait, IsSmooth) {
  const Shape walk, turn{.period = 1.8};
  for (const double amplitude : {0.0, 0.5, 1.0}) {
    JointAngles walked = walking(walk, 0, amplitude, {0.04, 0.04});
    JointAngles turned = turning(turn, 0, amplitude, 0.012);
    for (int i = 1; i <= 200; ++i) {
      const JointAngles w = walking(walk, 0.02 * i / walk.period, amplitude, {0.04, 0.04});
      const JointAngles t = turning(turn, 0.02 * i / turn.period, amplitude, 0.012);
      for (std::size_t j = 0; j < w.size(); ++j) {
        EXPECT_LT(std::abs(w[j] - walked[j]), 0.24) << i << " " << j;
        EXPECT_LT(std::abs(t[j] - turned[j]), 0.24) << i << " " << j;
        if (amplitude == 0) {
          EXPECT_NEAR(w[j], home()[j], 1e-12);
        }
      }
      walked = w;
      turned = t;
    }
  }
}

// Without sensor noise, quantisation and backlash, the gait that starts with the other foot is mirrored:
// solver and contacts have no left-right bias. Rounding errors grow by about a factor e per second of
// walking; the tolerance of 0.02 degrees is far above them and far below the 1.3 degrees by which the start
// turns the robot.
TEST(Gait, StartingWithTheOtherFootMirrorsIt) {
  std::array<double, 2> heading{}, aside{};
  for (const std::size_t foot : {0, 1}) {
    sim::WorldOptions options;
    options.ideal_motors = true;
    auto loaded = sim::World::load(KAZ_ROBOT "/../../../sim/worlds/empty.sdf",
                                   KAZ_ROBOT "/kaz.urdf", options);
    ASSERT_TRUE(loaded) << loaded.error().message;
    sim::World& world = **loaded;
    const Shape shape{.roll = 16 * kDegree};
    std::array<sim::MotorDrive, KZ_JOINTS> drives{};
    for (int i = 0; i < 6000; ++i) {
      const double time = world.time_s(), walked = std::max(0.0, time - 2.5);
      JointAngles target = walking(shape, walked + 0.5 * static_cast<double>(foot),
                                   std::min(1.0, walked / 1.5), {0.04, 0.04});
      for (std::size_t j = 0; j < target.size(); ++j) {
        const sim::JointState& joint = world.joints()[j];
        const double error = std::min(1.0, time / 2) * target[j] - joint.angle;
        drives[j] = {std::clamp(20 * error - 0.15 * joint.velocity, -1.0, 1.0), true};
      }
      world.step(drives, 10.0);
    }
    const Eigen::Isometry3d trunk = world.link_pose("trunk");
    EXPECT_GT(trunk.translation().x(), 0.12) << "it must really walk";
    heading[foot] = std::atan2(trunk.linear()(1, 0), trunk.linear()(0, 0)) / kDegree;
    aside[foot] = trunk.translation().y();
  }
  std::printf("heading %.4f and %.4f deg\n", heading[0], heading[1]);
  EXPECT_GT(std::abs(heading[0]), 0.1);
  EXPECT_NEAR(heading[0], -heading[1], 0.02);
  EXPECT_NEAR(aside[0], -aside[1], 1e-4);
}

// About 30 seeds were all within these margins (docs/results/README.md).
TEST(Gait, WalksHalfAMetre) {
  for (const std::uint64_t seed : {1, 2}) {
    const Outcome out = run("walk 0.5 m, roll 20", seed);
    EXPECT_FALSE(out.fell);
    EXPECT_NEAR(out.forward_m, 0.5, 0.03);
    EXPECT_LT(std::abs(out.heading_deg), 4);
    EXPECT_LT(out.aside_m, 0.05);
    EXPECT_LT(out.seconds, 15);
  }
}

TEST(Gait, TurnsBySlip) {
  const Outcome left = run("slow turn +45, mu 0.7", 1);
  EXPECT_FALSE(left.fell);
  EXPECT_NEAR(left.heading_deg, 46, 6);
  const Outcome cycles = run("slow turn 3 cycles, mu 0.4", 1);
  EXPECT_FALSE(cycles.fell);
  ASSERT_EQ(cycles.per_cycle_deg.size(), 3u);
  for (const double turned : cycles.per_cycle_deg) EXPECT_NEAR(turned, 25, 5);
}

TEST(Gait, PicksUpTheBall) {
  const Outcome out = run("catch", 1);
  EXPECT_TRUE(out.caught);
  EXPECT_LT(out.grasp_mm, 15);
}

TEST(Gait, IsDeterministicForASeed) {
  const Outcome one = run("slow turn +45, mu 0.7", 3), two = run("slow turn +45, mu 0.7", 3);
  EXPECT_EQ(one.heading_deg, two.heading_deg);
  EXPECT_EQ(one.path, two.path);
  EXPECT_NE(one.heading_deg, run("slow turn +45, mu 0.7", 4).heading_deg);
}

}  // namespace
}  // namespace kaz::gait
