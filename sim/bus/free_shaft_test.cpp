// Servos whose shafts turn freely, and motors with different supplies, in a world.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/motor_file.h"
#include "sim/bus/bus_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using std::chrono::milliseconds;

std::string arm_of(int number) {
  const std::string n = std::to_string(number);
  return "<joint name='j" + n + "' type='continuous'><parent link='stand'/><child link='arm" + n +
         "'/><origin xyz='0 " + n + " 0.5'/><axis xyz='0 0 1'/></joint><link name='arm" + n +
         "'><inertial><mass value='0.02'/><inertia ixx='2e-5' iyy='2e-5' izz='2e-5' ixy='0' "
         "ixz='0' iyz='0'/></inertial></link>";
}

// A bus of two continuous joints with the motor of `robot`.
std::unique_ptr<VirtualBus> free_bus(const std::string& robot, const std::string& bus) {
  const Folder folder;
  const std::string urdf = folder.write(
      "bank.urdf",
      "<robot name='bank'><link name='stand'><inertial><mass value='5'/><inertia ixx='0.01' "
      "iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link>" +
          arm_of(1) + arm_of(2) + "</robot>");
  folder.write("motor.xml", read_text("sim/robots/" + robot + "/motor.xml"));
  folder.write("bus.json", bus);
  WorldOptions options;
  options.hung = true;
  auto loaded = VirtualBus::load("sim/worlds/empty.sdf", urdf, options);
  EXPECT_TRUE(loaded) << loaded.error().message;
  return loaded ? std::move(*loaded) : nullptr;
}

constexpr const char* kFeetechBus = R"({"protocol": "feetech", "supply_volts": 7.4, "servos": [
  {"joint": "j1", "id": 1, "model": "sts3215"}, {"joint": "j2", "id": 2, "model": "sts3215"}]})";

constexpr const char* kDynamixelBus = R"({"protocol": "dynamixel", "baud": 1000000,
  "supply_volts": 5, "servos": [{"joint": "j1", "id": 1, "model": "xl330-m288"},
  {"joint": "j2", "id": 2, "model": "xl330-m288", "supply_volts": 3.7}]})";

TEST(FreeShaft, OfAWheelTurnsOnAndItsPositionWraps) {
  const auto bus = free_bus("so101", kFeetechBus);
  ASSERT_TRUE(bus);
  BusHost host(*bus);
  ASSERT_TRUE(host.set(1, "mode", 1));
  ASSERT_TRUE(host.set(1, "torque_enable", 1));
  ASSERT_TRUE(host.set(1, "goal_speed", 2400));
  int lowest = 4095, highest = 0;
  for (int i = 0; i < 100; ++i) {
    bus->advance(bus->time() + milliseconds(50));
    const int position = host.get(1, "present_position");
    lowest = std::min(lowest, position);
    highest = std::max(highest, position);
  }
  EXPECT_LT(lowest, 150);
  EXPECT_GE(lowest, 0);
  EXPECT_GT(highest, 3945);
  EXPECT_LE(highest, 4095);
  EXPECT_GT(bus->angle(0), 4.5 * std::numbers::pi) << "more than two turns";
  EXPECT_NEAR(host.get(1, "present_speed"), 2400, 30);
  EXPECT_EQ(host.get(1, "status"), 0);
}

// Goals of several turns: mode 3, and mode 0 with bit 4 of `phase` and without angle limits.
TEST(FreeShaft, OfAnStsTurnsSeveralTimes) {
  const auto bus = free_bus("so101", kFeetechBus);
  ASSERT_TRUE(bus);
  BusHost host(*bus);
  ASSERT_TRUE(host.set(1, "mode", 3));
  ASSERT_TRUE(host.set(1, "goal_position", 3 * 4096));
  ASSERT_TRUE(host.set(2, "phase", 12 | 16));
  ASSERT_TRUE(host.set(2, "max_angle", 0));
  ASSERT_TRUE(host.set(2, "goal_position", -10000));
  bus->advance(milliseconds(6000));
  EXPECT_NEAR(bus->angle(0), 6 * std::numbers::pi, 0.05);
  EXPECT_NEAR(host.get(1, "present_position"), 2048, 30) << "within the turn";
  EXPECT_NEAR(host.get(2, "present_position"), -10000, 30);
  EXPECT_NEAR(bus->angle(1) * 2048 / std::numbers::pi, -12048, 30);
}

// Speed at which the identified friction takes the whole torque, rad/s.
double free_speed(const std::string& robot, double volts) {
  const MotorParams motor = load_motor_file("sim/robots/" + robot + "/motor.xml", "").value();
  double low = 0, high = 100;
  for (int i = 0; i < 50; ++i) {
    const double speed = 0.5 * (low + high);
    const double torque = motor.stall_slope_nm_per_v * volts - motor.back_emf_nms_per_rad * speed;
    const bool drives = torque > servo_model::friction_limit(
                                     motor.servo->model, motor.servo->params(), speed, torque, 0);
    (drives ? low : high) = speed;
  }
  return low;
}

// The maker's first example, goals 0 and 4095, and goals beyond a turn.
TEST(FreeShaft, OfADynamixelHasNoStop) {
  const auto bus = free_bus("mini", kDynamixelBus);
  ASSERT_TRUE(bus);
  DynamixelHost host(*bus);
  ASSERT_TRUE(host.set(1, "torque_enable", 1));
  for (const int goal : {0, 4095}) {
    ASSERT_TRUE(host.set(1, "goal_position", goal));
    bus->advance(bus->time() + milliseconds(1500));
    EXPECT_NEAR(host.get(1, "present_position"), goal, 25);
  }
  ASSERT_TRUE(host.set(1, "torque_enable", 0));
  ASSERT_TRUE(host.set(1, "operating_mode", 4));
  ASSERT_TRUE(host.set(1, "torque_enable", 1));
  ASSERT_TRUE(host.set(1, "goal_position", 5 * 4096));
  bus->advance(bus->time() + milliseconds(5000));
  EXPECT_NEAR(host.get(1, "present_position"), 5 * 4096, 25);
  EXPECT_EQ(host.get(1, "hardware_error_status"), 0);

  // Both at full duty: the no-load speed is that of each one's own supply.
  for (const int id : {1, 2}) {
    host.set(id, "torque_enable", 0);
    ASSERT_TRUE(host.set(id, "operating_mode", 16));
    ASSERT_TRUE(host.set(id, "torque_enable", 1));
    ASSERT_TRUE(host.set(id, "goal_pwm", 885));
  }
  bus->advance(bus->time() + milliseconds(1500));
  const auto joints = bus->world().joints();
  EXPECT_NEAR(joints[0].velocity, free_speed("mini", 5.0), 0.15);
  EXPECT_NEAR(joints[1].velocity, free_speed("mini", 3.7), 0.15);
}

}  // namespace
}  // namespace kaz::sim
