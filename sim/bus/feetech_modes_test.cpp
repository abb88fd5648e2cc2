// What a servo's motion registers do, with the motor model of sim/robots/so101 on its shaft.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/bus/servo_bench_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using feetech::Instruction;

TEST(PositionMode, MovesToTheGoalAndSaysSo) {
  ServoBench bench;
  bench.set("torque_enable", 1);
  bench.run(0.1);
  EXPECT_NEAR(bench.get("present_position"), 2048, 1) << "holds where it is";
  bench.set("goal_position", 3072);
  bench.run(0.1);
  EXPECT_EQ(bench.get("moving"), 1);
  EXPECT_GT(bench.get("present_speed"), 500);
  EXPECT_GT(bench.get("present_load"), 100);
  bench.run(1.4);
  // Stiction (0.24 Nm) at 11 Nm/rad is 14 steps, the least duty takes 3 of them.
  EXPECT_NEAR(bench.get("present_position"), 3072, 14);
  EXPECT_EQ(bench.get("moving"), 0);
  EXPECT_NEAR(bench.angle, std::numbers::pi / 2, 0.022);
}

TEST(PositionMode, TakesTheTimeOfItsProfile) {
  ServoBench bench;
  bench.set("torque_enable", 1);
  bench.set("acceleration", 20);  // 2,000 steps/s^2
  bench.set("goal_speed", 1000);  // steps/s
  bench.set("goal_position", 3548);
  // 0.5 s up, 0.5 s down, 1,000 of 1,500 steps between: 1 s more.
  bench.run(0.5);
  EXPECT_NEAR(bench.get("present_target"), 2048 + 250, 3);
  bench.run(0.5);
  EXPECT_NEAR(bench.get("present_target"), 2048 + 750, 3);
  EXPECT_NEAR(bench.get("present_speed"), 1000, 100);
  bench.run(0.9);
  EXPECT_EQ(bench.get("moving"), 1);
  bench.run(0.12);
  EXPECT_EQ(bench.get("present_target"), 3548);
  EXPECT_LE(bench.fastest * bench.steps_per_rad(), 1150);
}

TEST(PositionMode, NewGoalOnTheWayNeedsNoStop) {
  ServoBench bench;
  bench.set("torque_enable", 1);
  bench.set("acceleration", 50);
  bench.set("goal_speed", 1000);
  bench.set("goal_position", 4000);
  bench.run(0.8);
  const int speed = bench.get("present_speed");
  bench.set("goal_position", 3900);
  bench.run(0.01);
  EXPECT_NEAR(bench.get("present_speed"), speed, 60);
  bench.set("goal_position", 1000);
  bench.run(3.5);
  EXPECT_EQ(bench.get("present_target"), 1000);
}

TEST(PositionMode, GoalStaysInsideTheAngleLimits) {
  ServoBench bench;
  bench.set("max_angle", 2500);
  bench.set("min_angle", 1500);
  bench.set("torque_enable", 1);
  bench.set("goal_position", 4000);
  bench.run(1);
  EXPECT_EQ(bench.get("present_target"), 2500);
  EXPECT_EQ(bench.get("goal_position"), 4000);
  bench.set("goal_position", 0);
  bench.run(1);
  EXPECT_EQ(bench.get("present_target"), 1500);
}

TEST(PositionMode, SpeedZeroIsTheHighestUnlessPhaseSaysStop) {
  ServoBench bench;
  bench.set("torque_enable", 1);
  bench.set("goal_position", 4000);
  bench.run(1.5);
  EXPECT_NEAR(bench.get("present_position"), 4000, 14);
  bench.set("phase", 4);
  bench.set("goal_position", 1000);
  bench.run(1);
  EXPECT_NEAR(bench.get("present_position"), 4000, 14);
}

// With 254, the highest value, the profile is at 127 steps after 0.1 s.
TEST(PositionMode, AccelerationZeroIsNoLimit) {
  ServoBench bench;
  bench.set("torque_enable", 1);
  bench.run(0.01);
  bench.set("goal_position", 4000);
  bench.run(0.1);
  EXPECT_NEAR(bench.get("present_target"), 2048 + 325, 4);
}

TEST(PositionMode, GainsSetTheStiffness) {
  double turned[2];
  for (const int i : {0, 1}) {
    ServoBench bench;
    bench.set("position_p", i == 0 ? 16 : 32);
    bench.set("torque_enable", 1);
    bench.run(0.1);
    bench.load_nm = 1.0;
    bench.run(1);
    turned[i] = std::abs(bench.angle);
  }
  // At most 1 Nm over 0.166 P * 3.199 Nm, 0.059 rad at 32. At least 0.0292 rad, where motor and friction
  // together hold 1 Nm.
  EXPECT_GT(turned[1], 0.029);
  EXPECT_LT(turned[1], 0.059);
  EXPECT_NEAR(turned[0] / turned[1], 2, 0.35);
}

TEST(PositionMode, IntegralRemovesTheDroop) {
  ServoBench bench;
  bench.set("position_i", 40);
  bench.set("torque_enable", 1);
  bench.run(0.1);
  bench.load_nm = 1.0;
  bench.run(4);
  EXPECT_NEAR(bench.get("present_position"), 2048, 3);
}

TEST(PositionMode, TorqueLimitBoundsTheDuty) {
  ServoBench bench;
  bench.set("torque_enable", 1);
  bench.set("torque_limit", 300);
  bench.clamped = true;
  bench.set("goal_position", 4000);
  bench.run(1);
  EXPECT_EQ(bench.get("present_load"), 300);
}

TEST(PositionMode, DeadZoneIsLeftAlone) {
  ServoBench bench;
  bench.set("dead_zone_cw", 30);
  bench.set("dead_zone_ccw", 30);
  bench.set("torque_enable", 1);
  bench.run(0.05);
  bench.set("goal_position", 2048 + 25);
  bench.run(0.5);
  EXPECT_NEAR(bench.get("present_position"), 2048, 5);
  EXPECT_EQ(bench.get("present_load"), 0);
}

TEST(Torque, OffIsFreeAndDampingBrakes) {
  double fallen[2];
  for (const int torque : {0, 2}) {
    ServoBench bench;
    bench.set("torque_enable", torque);
    bench.load_nm = 0.8;
    bench.run(0.3);
    fallen[torque / 2] = bench.angle;
  }
  EXPECT_GT(fallen[0], 2 * fallen[1]);
  EXPECT_GT(fallen[1], 0.05);
}

// As servo_motion.h has it: ours.
TEST(Torque, SwitchedOnHoldsThePositionAndIsSwitchedOnByAGoal) {
  ServoBench bench;
  bench.angle = 0.5;
  bench.run(0.01);
  bench.set("torque_enable", 1);
  bench.run(0.5);
  EXPECT_NEAR(bench.angle, 0.5, 0.01);
  bench.set("torque_enable", 0);
  bench.run(0.01);
  bench.set("goal_position", 2048);
  EXPECT_EQ(bench.get("torque_enable"), 1);
  bench.run(1);
  EXPECT_NEAR(bench.angle, 0, 0.022);
  bench.set("torque_enable", 0);
  bench.run(0.01);
  bench.angle = -0.5;
  bench.set("torque_enable", 1);
  bench.run(0.5);
  EXPECT_NEAR(bench.angle, -0.5, 0.02) << "the goal of before is done with";
}

TEST(SpeedMode, FollowsTheSpeed) {
  ServoBench bench;
  bench.set("mode", 1);
  bench.set("torque_enable", 1);
  for (const int speed : {1000, -2000, 0}) {
    bench.set("goal_speed", speed);
    bench.run(1.5);
    EXPECT_NEAR(bench.get("present_speed"), speed, 60) << speed;
  }
}

TEST(SpeedMode, AcceleratesAsSet) {
  ServoBench bench;
  bench.set("mode", 1);
  bench.set("acceleration", 10);  // 1,000 steps/s^2
  bench.set("torque_enable", 1);
  bench.set("goal_speed", 2000);
  bench.run(1);
  EXPECT_NEAR(bench.get("present_speed"), 1000, 150);
}

TEST(DutyMode, DutyIsTheRegister) {
  ServoBench bench;
  bench.set("mode", 2);
  bench.set("torque_enable", 1);
  bench.set("goal_time", -500);
  bench.run(1);
  EXPECT_EQ(bench.get("present_load"), -500);
  // The speed at which the identified friction takes 0.4323 * 7.4 * 0.5 - 0.5607 w.
  EXPECT_NEAR(bench.speed, -2.686, 0.05);
}

TEST(StepMode, EachGoalMovesFurther) {
  ServoBench bench;
  bench.set("mode", 3);
  bench.set("torque_enable", 1);
  bench.set("goal_position", 3000);
  bench.run(2);
  bench.set("goal_position", 3000);
  bench.run(2);
  // 6,000 steps: past the end of the turn.
  EXPECT_NEAR(bench.angle * bench.steps_per_rad(), 6000, 14);
  bench.set("goal_position", -1000);
  bench.run(2);
  EXPECT_NEAR(bench.angle * bench.steps_per_rad(), 5000, 14);
}

TEST(Position, WrapsOrCountsTurnsAsPhaseSays) {
  ServoBench bench;
  bench.angle = 2 * std::numbers::pi;  // raw 6144
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 2048);
  bench.set("phase", 12 | 16);
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 6144);
  bench.send(feetech::request(1, Instruction::reset_turns));
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 2048);
}

TEST(Position, OffsetMovesTheZeroAndWraps) {
  ServoBench bench;
  bench.set("position_offset", 100);
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 1948);
  bench.angle = -1949.0 / bench.steps_per_rad();
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 4095) << "one step below 0";
}

// Three ways: torque switch 128, 0B, 0B with a value.
TEST(Position, IsCalibratedToTheMiddle) {
  for (const int way : {0, 1, 2}) {
    ServoBench bench;
    bench.angle = 1.0;  // raw 2700
    bench.run(0.001);
    ASSERT_EQ(bench.get("present_position"), 2700);
    if (way == 0) bench.set("torque_enable", 128);
    if (way == 1) bench.send(feetech::request(1, Instruction::set_middle));
    if (way == 2) bench.send(feetech::request(1, Instruction::set_middle, {0, 4}));
    bench.run(0.001);
    EXPECT_EQ(bench.get("present_position"), way == 2 ? 1024 : 2048) << way;
    EXPECT_EQ(bench.get("position_offset"), way == 2 ? 1676 : 652) << way;
    EXPECT_EQ(bench.get("torque_enable"), 0);
    EXPECT_EQ(bench.get("lock"), 1);
    bench.power_cycle();
    bench.run(0.001);
    EXPECT_EQ(bench.get("present_position"), way == 2 ? 1024 : 2048) << "kept without power";
  }
}

TEST(Position, CountsTurnsFromPowerOn) {
  ServoBench bench;
  bench.set("lock", 0);
  bench.set("phase", 12 | 16);
  bench.angle = -6 * std::numbers::pi;
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 2048 - 3 * 4096);
  bench.power_cycle();
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 2048);
}

// Bit 2 of `phase`: the unit of speeds is 1 step/s, else 50.
TEST(Phase, SelectsTheUnitOfSpeeds) {
  for (const auto& [phase, unit] : {std::pair{12, 1}, {8, 50}}) {
    ServoBench bench;
    bench.set("phase", phase);
    bench.set("torque_enable", 1);
    bench.set("goal_speed", 1000 / unit);
    bench.set("goal_position", 4000);
    bench.run(0.3);
    const int before = bench.get("present_target");
    bench.run(1);
    EXPECT_NEAR(bench.get("present_target") - before, 1000, 2) << phase;
    EXPECT_NEAR(bench.get("present_speed") * unit, 1000, 100) << phase;
    ServoBench wheel;
    wheel.set("phase", phase);
    wheel.set("mode", 1);
    wheel.set("torque_enable", 1);
    wheel.set("goal_speed", -2000 / unit);
    wheel.run(1.5);
    EXPECT_NEAR(wheel.speed * wheel.steps_per_rad(), -2000, 60) << phase;
  }
}

TEST(Phase, ReversesTheFeedbackAndTheDrive) {
  ServoBench bench;
  bench.angle = 0.5;
  bench.run(0.001);
  const int before = bench.get("present_position");
  bench.set("phase", 12 | 128);
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 4095 - before);
  // Both bits: the servo turns the other way, and its loops are as stable as before.
  bench.set("phase", 12 | 128 | 1);
  bench.set("torque_enable", 1);
  bench.set("goal_position", 3000);
  bench.run(0.2);
  EXPECT_GT(bench.get("present_speed"), 500);
  EXPECT_GT(bench.get("present_load"), 0);
  EXPECT_GT(bench.get("present_current"), 0);
  EXPECT_LT(bench.speed, 0);
  bench.run(1.5);
  EXPECT_NEAR(bench.get("present_position"), 3000, 14);
  EXPECT_NEAR(bench.angle * bench.steps_per_rad(), 4095 - 3000 - 2048, 14);
  // The drive alone: a duty turns the motor backward.
  ServoBench driven;
  driven.set("phase", 12 | 1);
  driven.set("mode", 2);
  driven.set("torque_enable", 1);
  driven.set("goal_time", 1000);
  driven.run(4);
  EXPECT_LT(driven.speed, -4.5);
  EXPECT_EQ(driven.get("present_load"), 970);
  EXPECT_EQ(driven.get("status"), 0) << "free running is no overload";
}

TEST(Scs, GoalTimeIsTheTimeOfTheMotion) {
  ServoBench bench("scs0009");
  bench.set("torque_enable", 1);
  bench.run(0.01);
  bench.set("goal_time", 1000);
  bench.set("goal_position", 712);
  bench.run(0.5);
  // 200 steps/s (1.02 rad/s) take a duty of 0.26, and that an error of 20 steps at P = 15.
  EXPECT_NEAR(bench.get("present_position"), 612 - 20, 4);
  EXPECT_EQ(bench.get("moving"), 1);
  bench.run(0.8);
  EXPECT_NEAR(bench.get("present_position"), 712, 8);
  EXPECT_EQ(bench.get("moving"), 0);
}

TEST(Scs, WithoutAngleLimitsItsTimeIsADuty) {
  ServoBench bench("scs0009");
  bench.set("min_angle", 0);
  bench.set("max_angle", 0);
  bench.set("torque_enable", 1);
  bench.set("goal_time", 1024 + 400);
  bench.run(0.5);
  EXPECT_EQ(bench.get("present_load"), -400);
  EXPECT_LT(bench.speed, -1);
}

TEST(Scs, SensorEndsWhereItEnds) {
  ServoBench bench("scs0009");
  bench.angle = 4;
  bench.run(0.001);
  EXPECT_EQ(bench.get("present_position"), 1023);
}

}  // namespace
}  // namespace kaz::sim
