// Overload, overcurrent, voltage, temperature: when they act, what they do, and what releases them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/feetech_protection.h"

#include <gtest/gtest.h>

#include "shared/feetech/packet.h"
#include "sim/bus/servo_bench_testing.h"

namespace kaz::sim {
namespace {

using namespace test;

ServoBench stalled() {
  ServoBench bench;
  bench.set("torque_enable", 1);
  bench.clamped = true;
  bench.set("goal_position", 4000);
  return bench;
}

TEST(Overload, LimitsTheOutputAfterItsTimeUntilTheNextGoal) {
  ServoBench bench = stalled();
  bench.run(1.9);
  EXPECT_EQ(bench.get("present_load"), 970);
  EXPECT_EQ(bench.get("status"), 0);
  bench.run(0.5);  // 2 s after the duty passed 80 %
  EXPECT_EQ(bench.get("present_load"), 200);
  EXPECT_EQ(bench.get("status"), feetech::kOverloadError);
  // The bit is in every answer.
  const auto answer = bench.send(feetech::request(1, feetech::Instruction::ping));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->bytes[4], feetech::kOverloadError);
  bench.run(10);
  EXPECT_EQ(bench.get("present_load"), 200) << "latched";
  bench.clamped = false;
  bench.set("goal_position", 2048);
  bench.run(1);
  EXPECT_EQ(bench.get("status"), 0);
  EXPECT_NEAR(bench.get("present_position"), 2048, 14);
}

// The goal of each mode, and a goal of another mode, which releases nothing.
TEST(Overload, IsReleasedByTheGoalOfTheMode) {
  struct Case {
    int mode;
    const char *goal, *other;
    int value;
  };
  for (const Case& c :
       {Case{1, "goal_speed", "goal_time", 2400}, {2, "goal_time", "goal_speed", 1000}}) {
    ServoBench bench;
    bench.set("mode", c.mode);
    bench.set("torque_enable", 1);
    bench.clamped = true;
    bench.set(c.goal, c.value);
    bench.run(4);
    EXPECT_EQ(bench.get("status"), feetech::kOverloadError) << c.mode;
    EXPECT_EQ(bench.get("present_load"), 200) << c.mode;
    bench.set(c.other, 100);
    bench.set("goal_position", 1000);
    bench.run(0.1);
    EXPECT_EQ(bench.get("status"), feetech::kOverloadError) << c.mode;
    bench.set(c.goal, -c.value);
    bench.clamped = false;
    bench.run(1);
    EXPECT_EQ(bench.get("status"), 0) << c.mode;
    EXPECT_LT(bench.speed, -3) << c.mode;
  }
}

TEST(Overload, IsReportedOnlyWhereItsBitIsClear) {
  ServoBench bench;
  bench.set("unload_condition", 44 & ~feetech::kOverloadError);
  bench.set("torque_enable", 1);
  bench.clamped = true;
  bench.set("goal_position", 4000);
  bench.run(3);
  EXPECT_EQ(bench.get("status"), feetech::kOverloadError);
  EXPECT_EQ(bench.get("present_load"), 970);
}

TEST(Overload, FreeRunningAtFullSpeedIsNone) {
  ServoBench bench;
  bench.set("mode", 2);
  bench.set("torque_enable", 1);
  bench.set("goal_time", 1000);
  bench.run(5);
  EXPECT_EQ(bench.get("status"), 0);
  EXPECT_GT(bench.speed, 4.5);
}

TEST(Overcurrent, SwitchesTheOutputOff) {
  ServoBench bench;
  bench.set("protection_current", 100);  // 0.65 A; stalled at 7.2 V it takes 2.4
  bench.set("overcurrent_time", 50);     // 0.5 s
  bench.set("torque_enable", 1);
  bench.clamped = true;
  bench.set("goal_position", 4000);
  bench.run(0.3);
  EXPECT_NEAR(bench.get("present_current"), 366, 18);
  bench.run(0.7);
  EXPECT_EQ(bench.get("status"), feetech::kCurrentError);
  EXPECT_EQ(bench.get("present_load"), 0);
  bench.set("goal_position", 3900);
  bench.run(0.3);
  EXPECT_EQ(bench.get("status"), 0);
  EXPECT_GT(bench.get("present_load"), 900);
}

TEST(Voltage, IsReportedWhileItIsOutsideAndActsIfSelected) {
  ServoBench bench;
  bench.set("torque_enable", 1);
  bench.run(0.1);
  for (const auto& [volts, bad] : {std::pair{8.2, true}, {7.4, false}, {3.8, true}, {6.0, false}}) {
    bench.volts = volts;
    bench.run(0.01);
    EXPECT_EQ(bench.get("present_voltage"), std::lround(10 * volts));
    EXPECT_EQ(bench.get("status"), bad ? feetech::kVoltageError : 0) << volts;
  }
  bench.volts = 7.4;
  bench.set("unload_condition", feetech::kVoltageError);
  bench.clamped = true;
  bench.set("goal_position", 4000);
  bench.run(0.3);
  EXPECT_GT(bench.get("present_load"), 900);
  bench.volts = 3.8;
  bench.run(0.01);
  EXPECT_EQ(bench.get("present_load"), 0);
  bench.volts = 7.4;
  bench.run(0.01);
  EXPECT_GT(bench.get("present_load"), 900);
}

// Stalled at some 10 W, with the overload's protection off.
TEST(Temperature, SwitchesTheTorqueOff) {
  ServoBench bench;
  bench.set("unload_condition", feetech::kTemperatureError);
  bench.set("max_temperature", 40);
  bench.set("torque_enable", 1);
  bench.clamped = true;
  bench.set("goal_position", 4000);
  bench.run(0.3);
  EXPECT_EQ(bench.get("present_temperature"), 25);
  for (int i = 0; i < 200 && bench.get("torque_enable") != 0; ++i) bench.run(1);
  EXPECT_EQ(bench.get("torque_enable"), 0);
  EXPECT_EQ(bench.get("present_temperature"), 41);
  EXPECT_EQ(bench.get("status") & feetech::kTemperatureError, feetech::kTemperatureError);
  EXPECT_EQ(bench.get("present_load"), 0);
  // It cools down, and the host switches the torque on again.
  bench.run(900);
  EXPECT_EQ(bench.get("status") & feetech::kTemperatureError, 0);
  EXPECT_LT(bench.get("present_temperature"), 40);
  EXPECT_EQ(bench.get("torque_enable"), 0);
  bench.set("torque_enable", 1);
  bench.run(0.1);
  EXPECT_EQ(bench.get("torque_enable"), 1);
}

}  // namespace
}  // namespace kaz::sim
