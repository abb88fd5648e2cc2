// Protection of the motors: what must switch them off, and what must not.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/protection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/servo/joint_loop.h"
#include "shared/servo/joints.h"
#include "shared/servo/test_board.h"

namespace kaz::test {
namespace {

constexpr int knee = 12;  // not mirrored, 0.67 rad at mid-scale
constexpr u32 only_knee = 1u << knee;

class Protection : public testing::Test {
 protected:
  // The knee is on and asks for `share` of full duty; 256 /rad units.
  void push(double share) {
    ASSERT_EQ(board.heartbeat(100), 0);
    ASSERT_EQ(board.enable(only_knee), 0);
    ASSERT_EQ(board.gains(only_knee, 2560, 0), 0);  // 10 /rad
    kz_joint& joint = board.servo.joint[knee];
    joint.command = joint.target = static_cast<s16>(joint.angle + std::lround(share * 1000));
  }
  // Milliseconds until the motors go off, at most `most`; the host says now and then that it is there.
  int until_off(int most) {
    for (int ms = 0; ms < most; ++ms) {
      if (ms % 500 == 0) board.send(KZ_TYPE_heartbeat, ++board.sequence, {0, 0});
      if (!board.drivers_on()) return ms;
      board.tick();
    }
    return most;
  }
  kz_joint& joint() { return board.servo.joint[knee]; }

  TestBoard board;
};

TEST_F(Protection, AStalledMotorIsSwitchedOffAfterASecond) {
  push(1.0);
  EXPECT_NEAR(until_off(5000), 1000, 60);
  EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_STALL);
  EXPECT_EQ(board.servo.shutdown_detail, knee);
  board.ticks(20);
  EXPECT_EQ(board.clear(), 0);  // it is not stalled any more: it is off
}

TEST_F(Protection, StallIsToldBeforeItSwitchesOff) {
  push(1.0);
  board.ticks(500);
  EXPECT_TRUE(kz_joint_flags(&board.servo.joint[knee], 0) & KZ_JOINT_STALLED);
  EXPECT_TRUE(board.drivers_on());
  EXPECT_NEAR(kz_joint_load(&joint()), 252, 1);
}

TEST_F(Protection, HighLoadForLessThanASecondIsNoStall) {
  for (int i = 0; i < 3; ++i) {
    push(1.0);
    board.ticks(900);
    joint().command = joint().angle;
    EXPECT_EQ(until_off(1000), 1000) << i;
  }
}

TEST_F(Protection, AMotorThatMovesUnderHighLoadIsNotStalled) {
  push(1.0);
  for (int ms = 0; ms < 1500; ++ms) {
    if (ms % 500 == 0) board.send(KZ_TYPE_heartbeat, ++board.sequence, {0, 0});
    board.set_pot(knee, static_cast<u16>(512 + ms / 25));  // 0.13 rad/s
    joint().command = static_cast<s16>(joint().angle + 1000);
    board.tick();
    ASSERT_TRUE(board.drivers_on()) << ms;
  }
}

// load^2 with one time constant against the load that is allowed for ever.
double seconds_to_heat(double load) {
  const double tau = 0.016 * 8192, limit = 89.0 / 255;
  return -tau * std::log(1 - limit * limit / (load * load));
}

TEST_F(Protection, HeatFollowsTheModel) {
  for (const double share : {0.4, 0.5, 0.65}) {
    board = TestBoard();
    push(share);
    const double expected = seconds_to_heat(share * 252 / 255);
    EXPECT_NEAR(until_off(300'000) / 1000.0, expected, 0.05 * expected) << share;
    EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_OVERLOAD) << share;
    EXPECT_EQ(board.servo.shutdown_detail, knee);
    EXPECT_EQ(board.clear(), KZ_REFUSED_FAULT);  // still hot
  }
}

TEST_F(Protection, WhatIsHotCoolsDownAndThenCanBeCleared) {
  push(0.65);
  ASSERT_LT(until_off(300'000), 300'000);
  const double tau = 0.016 * 8192;
  board.ticks(static_cast<int>(1000 * tau * std::log(2.0) * 0.95));
  EXPECT_EQ(board.clear(), KZ_REFUSED_FAULT);
  board.ticks(static_cast<int>(1000 * tau * std::log(2.0) * 0.10));
  EXPECT_EQ(board.clear(), 0);
}

TEST_F(Protection, ASteadyLoadOfAThirdIsHeldForEver) {
  push(0.34);  // 0.78 Nm
  EXPECT_EQ(until_off(600'000), 600'000) << int(board.servo.shutdown);
}

// Rounded constants and cut bits: a whole is 252.
TEST_F(Protection, LoadIsDutyLessBackEmf) {
  kz_servo& servo = board.servo;
  servo.enabled = 1;
  servo.supply_mv = 10'000;
  joint().duty = 255;
  joint().forward = 1;
  const auto load_at = [&](double rad_per_s) {
    joint().rate = static_cast<s16>(std::lround(rad_per_s * 640));
    servo.phase = knee;
    kz_protection_update(&servo);
    return static_cast<int>(joint().load);
  };
  EXPECT_NEAR(load_at(0), 252, 1);
  EXPECT_NEAR(load_at(12.97), 0, 2);
  EXPECT_NEAR(load_at(6.485), 126, 1);
  EXPECT_EQ(load_at(-6), 255);  // driven against its motion: more than stalled
  servo.supply_mv = 5'000;
  EXPECT_NEAR(load_at(0), 126, 1);
}

}  // namespace
}  // namespace kaz::test
