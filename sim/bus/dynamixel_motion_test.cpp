// What a DYNAMIXEL's registers of motion and protection do, with the motor of sim/robots/mini on its shaft.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/bus/dynamixel_servo.h"
#include "sim/bus/servo_bench_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using std::chrono::milliseconds;

constexpr double kVelocityUnit = 1000.0 / 64, kAccelerationUnit = 1e6 / 4096;

struct Bench : ServoBench {
  explicit Bench(const std::string& model = "xl330-m288", double inertia_kgm2 = 1e-4)
      : ServoBench(model, inertia_kgm2) {
    servo->set_up("return_delay_time", 0);
    run(0.01);
  }
  // Error byte of the answer.
  int set_error(const std::string& name, int value) {
    const auto answer = set(name, value);
    return answer ? answer->bytes.at(8) : -1;
  }
  int ping_error() {
    const auto answer =
        send(dynamixel::wire_of(dynamixel::request(1, dynamixel::Instruction::ping)));
    return answer ? answer->bytes.at(8) : -1;
  }
  void reboot() {
    send(dynamixel::wire_of(dynamixel::request(1, dynamixel::Instruction::reboot)));
    run(0.35);
  }
  double pulses_per_s() const { return speed * steps_per_rad(); }
};

TEST(DynamixelPosition, HoldsWhereItIsWhenSwitchedOnAndGoesToItsGoal) {
  Bench bench;
  bench.set("goal_position", 3000);
  bench.set("torque_enable", 1);
  bench.run(0.2);
  EXPECT_NEAR(bench.get("present_position"), 2048, 2) << "a goal from before is forgotten";
  EXPECT_EQ(bench.get("goal_position"), 2048);
  bench.set("goal_position", 3072);
  bench.run(0.05);
  EXPECT_EQ(bench.get("moving"), 1);
  EXPECT_GT(bench.get("present_velocity"), 50);
  EXPECT_GT(bench.get("present_pwm"), 200);
  EXPECT_GT(bench.get("present_current"), 10);
  bench.run(1.5);
  // Stiction 0.0167 Nm at P 400: 0.0029 x 400 x 5 V x 0.096 Nm/V = 0.55 Nm/rad, so 20 pulses.
  EXPECT_NEAR(bench.get("present_position"), 3072, 21);
  EXPECT_EQ(bench.get("moving"), 0);
  EXPECT_EQ(bench.get("moving_status") & 2, 0);
}

// BAM measured 0.0028774 P of duty for a rad; a clamped shaft shows it.
TEST(DynamixelPosition, PGainIsThatWhichWasMeasured) {
  Bench bench;
  bench.clamped = true;
  bench.set("torque_enable", 1);
  bench.run(0.01);
  for (const int p : {100, 400, 800}) {
    bench.set("position_p_gain", p);
    bench.set("goal_position", 2048 + 200);
    bench.run(0.1);
    const double rad = 200 / bench.steps_per_rad();
    EXPECT_NEAR(bench.get("present_pwm"), 885 * 0.0028774 * p * rad, 1.5) << p;
  }
  // As the manual has it for the others: P / 128.
  Bench other("xl430-w250");
  other.clamped = true;
  other.volts = 11.1;
  other.set("torque_enable", 1);
  other.run(0.01);
  other.set("goal_position", 2048 + 50);
  other.run(0.1);
  EXPECT_EQ(other.get("present_pwm"), 250) << "640 / 128 x 50";
}

TEST(DynamixelPosition, IAndDGainsAndFeedforward) {
  Bench bench;
  bench.clamped = true;
  bench.set("torque_enable", 1);
  bench.run(0.01);
  bench.set("position_p_gain", 0);
  bench.set("position_i_gain", 655);
  bench.set("goal_position", 2048 + 100);
  bench.run(0.2);
  EXPECT_NEAR(bench.get("present_pwm"), 200, 2) << "655 / 65536 x 100 pulses x 200 ms";
  bench.set("position_i_gain", 0);
  bench.set("feedforward_1st_gain", 200);
  bench.set("profile_velocity", 64);  // 1 pulse/ms
  bench.set("goal_position", 3048);
  bench.run(0.2);
  EXPECT_NEAR(bench.get("present_pwm"), 50, 1) << "200 / 4 x 1 pulse/ms";
  bench.set("feedforward_1st_gain", 0);
  bench.set("position_d_gain", 800);
  bench.run(0.1);
  EXPECT_NEAR(bench.get("present_pwm"), 50, 1) << "800 / 16 x 1 pulse/ms";
}

TEST(DynamixelProfile, TrapezoidOfVelocityTakesItsTime) {
  Bench bench;
  bench.set("torque_enable", 1);
  bench.run(0.01);
  bench.set("profile_velocity", 64);     // 1,000 pulses/s
  bench.set("profile_acceleration", 8);  // 1,953 pulses/s^2: 64 x 64 / 8 = 512 ms
  bench.set("goal_position", 3548);
  bench.run(0.01);
  EXPECT_EQ(bench.get("moving_status") >> 4, 3);
  bench.run(0.502);
  EXPECT_NEAR(bench.get("velocity_trajectory"), 64, 1);
  EXPECT_NEAR(bench.get("position_trajectory"), 2048 + 256, 4);
  bench.run(0.5);
  EXPECT_NEAR(bench.get("position_trajectory"), 2048 + 756, 5);
  EXPECT_NEAR(bench.get("present_velocity"), 64, 5);
  // 64 x 1,500 / 64 + 512 ms in all.
  bench.run(0.98);
  EXPECT_EQ(bench.get("moving_status") & 2, 2);
  bench.run(0.04);
  EXPECT_EQ(bench.get("moving_status") & 2, 0);
  EXPECT_EQ(bench.get("position_trajectory"), 3548);
  EXPECT_EQ(bench.get("velocity_trajectory"), 0);
}

TEST(DynamixelProfile, ShapesAndTimes) {
  struct Case {
    int drive_mode, velocity, acceleration, shape;
    double seconds;  // until the trajectory is there
  };
  // 1,000 pulses. By time: all of it, and of the acceleration, at most half.
  const Case cases[] = {{0, 0, 0, 0, 0.001},   {0, 0, 50, 0, 0.001},  {0, 64, 0, 1, 1.0},
                        {0, 128, 1, 2, 4.05},  {0, 64, 16, 3, 1.256}, {4, 800, 0, 1, 0.8},
                        {4, 800, 200, 3, 0.8}, {4, 800, 700, 2, 0.8}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.velocity * 100000 + c.acceleration);
    Bench bench;
    bench.set("drive_mode", c.drive_mode);
    bench.set("torque_enable", 1);
    bench.run(0.01);
    bench.set("profile_velocity", c.velocity);
    bench.set("profile_acceleration", c.acceleration);
    bench.set("goal_position", 3048);
    bench.run(0.001);
    EXPECT_NEAR(bench.get("moving_status") >> 4, c.shape,
                c.drive_mode == 4 && c.shape == 2 ? 1 : 0);
    int ms = 1;
    for (; bench.get("position_trajectory") != 3048 && ms < 9000; ++ms) bench.run(0.001);
    EXPECT_NEAR(1e-3 * ms, c.seconds, 0.02 * c.seconds + 0.004);
  }
}

TEST(DynamixelProfile, NewGoalOnTheWayNeedsNoStop) {
  Bench bench;
  bench.set("torque_enable", 1);
  bench.run(0.01);
  bench.set("profile_velocity", 64);
  bench.set("profile_acceleration", 20);
  bench.set("goal_position", 4000);
  bench.run(0.6);
  const int before = bench.get("velocity_trajectory");
  bench.set("goal_position", 3900);
  bench.run(0.002);
  EXPECT_NEAR(bench.get("velocity_trajectory"), before, 2);
}

TEST(DynamixelVelocity, FollowsItsGoalWithItsAcceleration) {
  Bench bench;
  ASSERT_EQ(bench.set_error("operating_mode", 1), 0);
  bench.set("torque_enable", 1);
  bench.run(0.1);
  EXPECT_NEAR(bench.pulses_per_s(), 0, 1) << "at rest until a goal is written";
  bench.set("goal_velocity", 200);
  bench.run(1.0);
  EXPECT_NEAR(bench.get("present_velocity"), 200, 4);
  EXPECT_NEAR(bench.pulses_per_s(), 200 * kVelocityUnit, 60);
  EXPECT_EQ(bench.get("moving"), 1);
  bench.set("profile_acceleration", 4);
  bench.set("goal_velocity", -100);
  bench.run(1.0);
  EXPECT_NEAR(bench.get("velocity_trajectory"), 200 - kAccelerationUnit * 4 / kVelocityUnit, 2);
  bench.run(6.0);
  EXPECT_NEAR(bench.get("present_velocity"), -100, 4);
  EXPECT_EQ(bench.set_error("goal_velocity", 446), 6);
}

TEST(DynamixelPwm, DrivesTheBridgeWithinItsSlope) {
  Bench bench;
  ASSERT_EQ(bench.set_error("operating_mode", 16), 0);
  bench.set("torque_enable", 1);
  bench.set("goal_pwm", 0);
  bench.run(0.1);
  bench.clamped = true;
  bench.set("goal_pwm", 885);
  bench.run(0.009);
  // 140 x 1.977 mV a ms: 9 of the 18 ms that 5 V take.
  EXPECT_NEAR(bench.get("present_pwm"), 441, 3);
  bench.run(0.02);
  EXPECT_EQ(bench.get("present_pwm"), 885);
  EXPECT_EQ(bench.set_error("goal_pwm", 886), 4);
}

TEST(DynamixelCurrent, IsHeldAndLimitsThePosition) {
  Bench bench;
  ASSERT_EQ(bench.set_error("operating_mode", 0), 0);
  bench.clamped = true;
  bench.set("torque_enable", 1);
  bench.set("goal_current", 300);
  bench.run(0.3);
  EXPECT_NEAR(bench.get("present_current"), 300, 10);
  bench.set("goal_current", -500);
  bench.run(0.3);
  EXPECT_NEAR(bench.get("present_current"), -500, 10);

  Bench limited;
  ASSERT_EQ(limited.set_error("operating_mode", 5), 0);
  limited.clamped = true;
  limited.set("torque_enable", 1);
  limited.set("goal_current", 200);
  EXPECT_EQ(limited.set_error("goal_position", 20000), 0) << "several turns";
  limited.run(0.3);
  EXPECT_NEAR(limited.get("present_current"), 200, 10);
}

// The XL330 measures the current of the supply, the XM430 that of the winding.
TEST(DynamixelCurrent, OfAnXl330IsThatOfTheSupply) {
  for (const auto& [model, unit_a, of_supply] :
       {std::tuple{"xl330-m288", 1e-3, true}, {"xm430-w350", 2.69e-3, false}}) {
    Bench bench(model);
    bench.set("operating_mode", 16);
    bench.clamped = true;
    bench.set("torque_enable", 1);
    bench.set("goal_pwm", -177);  // 20 %
    bench.run(0.2);
    const double winding_a = bench.motor.motor_current();
    EXPECT_LT(winding_a, -0.1);
    EXPECT_NEAR(unit_a * bench.get("present_current"), (of_supply ? 0.2 : 1) * winding_a, 0.003)
        << model;
  }
}

// 256 turns either way.
TEST(DynamixelTurns, ReachTheEndsOfTheExtendedRange) {
  for (const int end : {1048575, -1048575}) {
    Bench bench;
    ASSERT_EQ(bench.set_error("operating_mode", 4), 0);
    bench.angle = (end - (end > 0 ? 10000 : -10000) - 2048) / bench.steps_per_rad();
    bench.run(0.002);
    bench.set("torque_enable", 1);
    EXPECT_EQ(bench.set_error("goal_position", end + (end > 0 ? 1 : -1)), 4);
    EXPECT_EQ(bench.set_error("goal_position", end), 0);
    bench.run(3);
    EXPECT_NEAR(bench.get("present_position"), end, 25);
  }
}

TEST(DynamixelTurns, AreCountedAndForgotten) {
  Bench bench;
  ASSERT_EQ(bench.set_error("operating_mode", 4), 0);
  bench.set("torque_enable", 1);
  EXPECT_EQ(bench.set_error("goal_position", 2048 + 3 * 4096), 0);
  bench.run(4.0);
  EXPECT_NEAR(bench.get("present_position"), 2048 + 3 * 4096, 25);
  bench.set("torque_enable", 0);
  bench.run(0.2);
  const auto clear = [&] {
    const auto answer = bench.send(dynamixel::wire_of(
        dynamixel::request(1, dynamixel::Instruction::clear, {0x01, 0x44, 0x58, 0x4C, 0x22})));
    return answer ? answer->bytes.at(8) : -1;
  };
  bench.speed = 5;
  bench.run(0.002);
  EXPECT_EQ(clear(), 1) << "it turns";
  bench.speed = 0;
  bench.run(0.2);
  EXPECT_EQ(clear(), 0);
  bench.run(0.01);
  EXPECT_GE(bench.get("present_position"), 0);
  EXPECT_LT(bench.get("present_position"), 4096);
}

TEST(DynamixelTurns, HomingOffsetAndReverse) {
  Bench bench;
  bench.set("homing_offset", 500);
  bench.run(0.002);
  EXPECT_EQ(bench.get("present_position"), 2548);
  bench.set("homing_offset", 1025);
  bench.run(0.002);
  EXPECT_EQ(bench.get("present_position"), 2048) << "not in mode 3";
  bench.set("operating_mode", 4);
  bench.run(0.002);
  EXPECT_EQ(bench.get("present_position"), 3073);
  bench.set("operating_mode", 3);
  bench.set("homing_offset", 0);
  bench.set("drive_mode", 1);
  bench.angle = 0.5;
  bench.run(0.05);
  bench.set("torque_enable", 1);
  bench.run(0.1);
  const double turned = bench.angle * bench.steps_per_rad();
  EXPECT_GT(turned, 200);
  EXPECT_NEAR(bench.get("present_position"), 4096 - (2048 + turned), 3);
  bench.set("goal_position", 2048);
  bench.run(1.5);
  EXPECT_NEAR(bench.get("present_position"), 2048, 21);
  EXPECT_NEAR(bench.angle, 0, 0.04);
  bench.set("goal_position", 2500);
  bench.run(0.05);
  EXPECT_LT(bench.speed, 0);
  EXPECT_GT(bench.get("present_velocity"), 0);
}

TEST(DynamixelTorque, IsSwitchedOnByAGoalIfSetUpSo) {
  Bench bench;
  bench.set("drive_mode", 8);
  bench.set("goal_position", 2500);
  bench.run(1.5);
  EXPECT_EQ(bench.get("torque_enable"), 1);
  EXPECT_NEAR(bench.get("present_position"), 2500, 21);
  Bench at_start;
  at_start.set("startup_configuration", 1);
  at_start.power_cycle();
  at_start.load_nm = 0.1;
  at_start.run(0.5);
  EXPECT_EQ(at_start.get("torque_enable"), 1);
  EXPECT_NEAR(at_start.get("present_position"), 2048, 200);
}

TEST(DynamixelMode, BeginsAnew) {
  Bench bench;
  bench.set("position_p_gain", 5);
  bench.set("profile_velocity", 6);
  bench.set("goal_pwm", 100);
  bench.set("operating_mode", 4);
  EXPECT_EQ(bench.get("position_p_gain"), 400);
  EXPECT_EQ(bench.get("profile_velocity"), 0);
  EXPECT_EQ(bench.get("goal_pwm"), 885);
}

TEST(DynamixelWatchdog, StopsWhenTheBusIsSilent) {
  Bench bench;
  bench.set("operating_mode", 1);
  bench.set("torque_enable", 1);
  bench.set("bus_watchdog", 5);  // 100 ms
  bench.set("goal_velocity", 100);
  for (int i = 0; i < 10; ++i) {
    bench.run(0.05);
    (void)bench.ping_error();
  }
  EXPECT_NEAR(bench.get("present_velocity"), 100, 5) << "any request counts";
  bench.run(0.5);
  EXPECT_EQ(bench.get("bus_watchdog"), -1);
  EXPECT_EQ(bench.get("present_velocity"), 0);
  EXPECT_EQ(bench.set_error("goal_velocity", 50), 4);
  EXPECT_EQ(bench.set_error("bus_watchdog", 0), 0);
  EXPECT_EQ(bench.set_error("goal_velocity", 50), 0);
  bench.run(0.5);
  EXPECT_NEAR(bench.get("present_velocity"), 50, 5);
}

TEST(DynamixelProtection, StalledItShutsDownUntilAReboot) {
  Bench bench;
  bench.set("torque_enable", 1);
  bench.run(0.01);
  bench.clamped = true;
  bench.set("goal_position", 4000);
  bench.run(1.5);
  EXPECT_EQ(bench.get("present_pwm"), 885);
  EXPECT_EQ(bench.ping_error(), 0);
  bench.run(1.0);
  EXPECT_EQ(bench.get("hardware_error_status"), dynamixel::kOverloadError);
  EXPECT_EQ(bench.get("torque_enable"), 0);
  EXPECT_EQ(bench.get("present_pwm"), 0);
  EXPECT_EQ(bench.ping_error(), dynamixel::kAlert);
  EXPECT_EQ(bench.set_error("torque_enable", 1), dynamixel::kAlert | 1);
  bench.clamped = false;
  bench.reboot();
  EXPECT_EQ(bench.get("hardware_error_status"), 0);
  EXPECT_EQ(bench.set_error("torque_enable", 1), 0);
}

TEST(DynamixelProtection, WhatIsNotSelectedOnlyAlerts) {
  Bench bench;
  bench.set("shutdown", 0);
  bench.set("torque_enable", 1);
  bench.run(0.01);
  bench.volts = 3.2;
  bench.run(0.2);
  EXPECT_EQ(bench.get("present_input_voltage"), 32);
  EXPECT_EQ(bench.get("hardware_error_status"), dynamixel::kVoltageError);
  EXPECT_EQ(bench.ping_error(), dynamixel::kAlert);
  EXPECT_EQ(bench.get("torque_enable"), 1);
  bench.volts = 5;
  bench.run(0.2);
  EXPECT_EQ(bench.ping_error(), 0);
  // As from the factory the voltage of an XL330 shuts it down.
  Bench factory;
  factory.set("torque_enable", 1);
  factory.volts = 3.2;
  factory.run(0.2);
  EXPECT_EQ(factory.get("torque_enable"), 0);
  factory.volts = 5;
  factory.run(0.2);
  EXPECT_EQ(factory.ping_error(), dynamixel::kAlert);
}

TEST(DynamixelProtection, HeatShutsDown) {
  Bench bench;
  bench.set("temperature_limit", 26);
  bench.set("shutdown", 4);
  bench.set("torque_enable", 1);
  bench.clamped = true;
  bench.run(0.01);
  bench.set("goal_position", 4000);
  bench.run(60);
  EXPECT_GE(bench.get("present_temperature"), 27);
  EXPECT_EQ(bench.get("hardware_error_status") & dynamixel::kTemperatureError,
            dynamixel::kTemperatureError);
  EXPECT_EQ(bench.get("torque_enable"), 0);
}

TEST(DynamixelTick, CountsMilliseconds) {
  Bench bench;
  const int before = bench.get("realtime_tick");
  bench.run(0.25);
  EXPECT_EQ(bench.get("realtime_tick"), before + 250);
}

}  // namespace
}  // namespace kaz::sim
