// The arm of six STS3215 in its world, over the bus: it moves, stalls, pulls its supply down, and falls.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/body/description/motor_file.h"
#include "sim/bus/bus_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using feetech::request;
using std::chrono::milliseconds;

std::unique_ptr<VirtualBus> arm(const std::string& world = "sim/worlds/empty.sdf") {
  auto bus = VirtualBus::load(world, "sim/robots/so101/so101.urdf", {});
  EXPECT_TRUE(bus) << bus.error().message;
  return bus ? std::move(*bus) : nullptr;
}

Packet goals(const std::vector<int>& goals) {
  Bytes parameters{42, 2};
  for (std::size_t i = 0; i < goals.size(); ++i) {
    parameters.push_back(static_cast<std::uint8_t>(i + 1));
    parameters.push_back(static_cast<std::uint8_t>(goals[i]));
    parameters.push_back(static_cast<std::uint8_t>(goals[i] >> 8));
  }
  return request(feetech::kBroadcast, Instruction::sync_write, parameters);
}

// The data sheet at 7.4 V and the maker's site at 6 V: speed without load. Identified values of the torque
// constant are 1.18 to 1.30 Nm/A.
TEST(Arm, MotorsFollowTheirSources) {
  constexpr double kFriction = 0.14;  // N m, of the identified gear without load
  struct Source {
    const char* name;
    double volts, free_rad_per_s;
  };
  for (const Source& source : {Source{"", 7.4, 5.445}, {"sts3215-6v", 6, 4.40}}) {
    const auto motor = load_motor_file("sim/robots/so101/motor.xml", source.name);
    ASSERT_TRUE(motor) << motor.error().message;
    const double free_nm = motor->stall_slope_nm_per_v * source.volts - kFriction;
    EXPECT_NEAR(free_nm / motor->back_emf_nms_per_rad, source.free_rad_per_s, 0.06) << source.name;
    EXPECT_NEAR(motor->torque_constant(), 1.24, 0.06) << source.name;
    ASSERT_TRUE(motor->servo) << source.name;
    EXPECT_EQ(motor->rotor_inertia_kgm2, motor->servo->params().armature);
  }
}

TEST(Arm, FollowsItsGoals) {
  const auto bus = arm();
  ASSERT_TRUE(bus);
  BusHost host(*bus);
  for (int id = 1; id <= 6; ++id) ASSERT_TRUE(host.set(id, "torque_enable", 1));
  const std::vector<int> targets{2500, 1700, 2400, 2300, 1600, 2600};
  EXPECT_TRUE(host.send(goals(targets)).empty());
  bus->advance(bus->time() + milliseconds(2000));
  for (int id = 1; id <= 6; ++id) {
    const auto i = static_cast<std::size_t>(id - 1);
    // Gravity of up to 0.7 Nm and stiction at 11 Nm/rad.
    EXPECT_NEAR(host.get(id, "present_position"), targets[i], 60) << id;
    EXPECT_NEAR(bus->mount(i).steps_at(bus->world().joints()[i].angle), targets[i], 60) << id;
    EXPECT_EQ(host.get(id, "moving"), 0) << id;
  }
  EXPECT_TRUE(bus->world().diagnostics().failure.empty());
  // Nothing trembles.
  std::vector<double> before;
  for (const auto& joint : bus->world().joints()) before.push_back(joint.angle);
  bus->advance(bus->time() + milliseconds(1000));
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(bus->world().joints()[i].angle, before[i], 0.01) << i;
}

TEST(Arm, FallsWithoutTorque) {
  const auto bus = arm();
  ASSERT_TRUE(bus);
  const double before = bus->world().link_pose("gripper").translation().z();
  bus->advance(milliseconds(3000));
  EXPECT_LT(bus->world().link_pose("gripper").translation().z(), before - 0.05);
}

// The gripper closes on itself: its stop is what it stalls at.
TEST(Arm, StalledJointShutsDownAndIsReleased) {
  const auto bus = arm();
  ASSERT_TRUE(bus);
  BusHost host(*bus);
  ASSERT_TRUE(host.set(6, "torque_enable", 1));
  ASSERT_TRUE(host.set(6, "goal_position", 1000));
  bus->advance(bus->time() + milliseconds(1500));
  EXPECT_NEAR(host.get(6, "present_load"), -970, 5);
  bus->advance(bus->time() + milliseconds(2500));
  const auto answers = host.send(request(6, Instruction::ping));
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].code, feetech::kOverloadError);
  bus->advance(bus->time() + milliseconds(3));
  host.set(6, "goal_position", 2048);
  bus->advance(bus->time() + milliseconds(1000));
  EXPECT_EQ(host.get(6, "status"), 0);
  EXPECT_NEAR(host.get(6, "present_position"), 2048, 60);
}

TEST(Arm, SupplySagIsSeen) {
  const auto bus = arm();
  ASSERT_TRUE(bus);
  BusHost host(*bus);
  bus->advance(milliseconds(10));
  EXPECT_EQ(host.get(1, "present_voltage"), 74);
  for (int id = 1; id <= 6; ++id) ASSERT_TRUE(host.set(id, "torque_enable", 1));
  EXPECT_TRUE(host.send(goals({3000, 1200, 2900, 2900, 3000, 3000})).empty());
  int lowest = 100;
  for (int i = 0; i < 50; ++i) lowest = std::min(lowest, host.get(1, "present_voltage"));
  EXPECT_LE(lowest, 71);
  bus->set_supply_volts(3.5);
  bus->advance(bus->time() + milliseconds(10));
  const auto answers = host.send(request(1, Instruction::ping));
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].code, feetech::kVoltageError);
}

TEST(Arm, SameCallsGiveTheSameBytes) {
  std::vector<int> seen[2];
  for (auto& run : seen) {
    const auto bus = arm();
    ASSERT_TRUE(bus);
    bus->line().set_damage(0.01, 5);
    BusHost host(*bus);
    for (int id = 1; id <= 6; ++id) host.set(id, "torque_enable", 1);
    for (int i = 0; i < 100; ++i) {
      host.send(goals({2048 + i, 2048 - i, 2048 + 2 * i, 2048, 2048, 2100}));
      run.push_back(host.get(1 + i % 6, "present_position"));
    }
  }
  EXPECT_EQ(seen[0], seen[1]);
}

}  // namespace
}  // namespace kaz::sim
