// The humanoid of XL330 in its world, over the bus: it follows its goals, suspended and on its feet.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "sim/bus/bus_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using std::chrono::milliseconds;
using Op = dynamixel::Instruction;

constexpr const char* kMini = "sim/robots/mini/mini.urdf";
constexpr const char* kFloor = "sim/worlds/empty.sdf";

dynamixel::Packet sync_write(std::uint8_t address, const std::map<int, int>& values) {
  Bytes parameters{address, 0, 4, 0};
  for (const auto& [id, value] : values) {
    parameters.push_back(static_cast<std::uint8_t>(id));
    for (int k = 0; k < 4; ++k)
      parameters.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(value) >> (8 * k)));
  }
  return dynamixel::request(dynamixel::kBroadcast, Op::sync_write, parameters);
}

TEST(Mini, FollowsItsGoals) {
  WorldOptions options;
  options.hung = true;
  const auto bus = VirtualBus::load(kFloor, kMini, options);
  ASSERT_TRUE(bus) << bus.error().message;
  VirtualBus& mini = **bus;
  DynamixelHost host(mini);
  mini.advance(milliseconds(5));
  EXPECT_EQ(host.get(31, "return_delay_time"), 0) << "set up so in bus.json";
  std::map<int, int> goals;
  for (std::size_t i = 0; i < mini.servos(); ++i) goals[mini.mount(i).id] = 2048 + 150;
  for (const auto& [id, goal] : goals) ASSERT_TRUE(host.set(id, "torque_enable", 1)) << id;
  EXPECT_TRUE(host.send(sync_write(112, {{11, 100}, {12, 100}})).empty());
  // Elbows bend the other way.
  goals[12] = goals[22] = 2048 - 400;
  EXPECT_TRUE(host.send(sync_write(116, goals)).empty());
  mini.advance(mini.time() + milliseconds(2000));
  for (std::size_t i = 0; i < mini.servos(); ++i) {
    const int id = mini.mount(i).id;
    // Weights of up to 0.02 Nm and stiction at 0.55 Nm/rad.
    EXPECT_NEAR(host.get(id, "present_position"), goals[id], 60) << mini.mount(i).joint;
  }
  EXPECT_TRUE(mini.world().diagnostics().failure.empty());
}

// On its feet, by position loops alone.
TEST(Mini, CrouchesAndRises) {
  const auto loaded = VirtualBus::load(kFloor, kMini, {});
  ASSERT_TRUE(loaded) << loaded.error().message;
  VirtualBus& mini = **loaded;
  DynamixelHost host(mini);
  std::map<int, int> goals, velocities;
  for (std::size_t i = 0; i < mini.servos(); ++i) {
    const int id = mini.mount(i).id;
    ASSERT_TRUE(host.set(id, "torque_enable", 1)) << id;
    // With the factory's 400, 0.55 Nm/rad, it topples.
    ASSERT_TRUE(host.set(id, "position_p_gain", 1600)) << id;
    goals[id] = 2048;
    velocities[id] = 20;  // 0.48 rad/s
  }
  // Knees turn by twice as much.
  velocities[34] = velocities[44] = 40;
  EXPECT_TRUE(host.send(sync_write(112, velocities)).empty());
  const auto height_after = [&](double bend_rad) {
    const int steps =
        static_cast<int>(std::lround(bend_rad * mini.mount(0).model->steps_per_rad()));
    for (const int leg : {30, 40}) {
      goals[leg + 3] = goals[leg + 5] = 2048 - steps;
      goals[leg + 4] = 2048 + 2 * steps;
    }
    EXPECT_TRUE(host.send(sync_write(116, goals)).empty());
    mini.advance(mini.time() + milliseconds(4000));
    return mini.world().link_pose("trunk").translation().z();
  };
  EXPECT_NEAR(height_after(0), 0.178, 0.003);
  // Two links of 62 mm: 124 (1 - cos 0.5) = 15 mm lower.
  EXPECT_NEAR(height_after(0.5), 0.163, 0.004);
  EXPECT_NEAR(height_after(0), 0.178, 0.003);
  const auto upright = mini.world().link_pose("trunk").linear()(2, 2);
  EXPECT_GT(upright, 0.99);
  EXPECT_TRUE(mini.world().diagnostics().failure.empty());
}

}  // namespace
}  // namespace kaz::sim
