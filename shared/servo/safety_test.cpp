// When the motors go off, and that they stay off.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "shared/servo/board_testing.h"

namespace kaz::test {
namespace {

constexpr u32 kAllJoints = (1u << KZ_JOINTS) - 1;

bool all_off(const kz_tick_output& output) {
  int sum = output.p3 | output.p4 | output.p5 | output.p6;
  for (const u8 duty : output.pw) sum |= duty;
  for (const u8 duty : output.tmo) sum |= duty;
  return sum == 0;
}

TEST(Safety, EverythingIsOffUntilTheHostEnables) {
  TestBoard board;
  EXPECT_TRUE(all_off(board.output));
  for (int i = 0; i < 1000; ++i) {
    board.set_pot(i % KZ_JOINTS, static_cast<u16>(4 + i));
    board.tick();
    ASSERT_TRUE(all_off(board.output));
  }
}

TEST(Safety, EnableDoesNotMoveAJointWhereverItStands) {
  for (const u16 code : {4, 100, 512, 900, 1019}) {
    TestBoard board;
    for (int joint = 0; joint < KZ_JOINTS; ++joint) board.set_pot(joint, code);
    board.ticks(100);  // the jump is no motion any more
    ASSERT_EQ(board.heartbeat(100), 0);
    ASSERT_EQ(board.enable(kAllJoints), 0);
    for (int i = 0; i < 100; ++i) {
      board.tick();
      ASSERT_TRUE(board.drivers_on());
      for (const u8 duty : board.output.pw) ASSERT_EQ(duty, 0);
      for (const u8 duty : board.output.tmo) ASSERT_EQ(duty, 0);
    }
  }
}

TEST(Safety, EnableAgainLeavesARunningJointAlone) {
  TestBoard board;
  ASSERT_EQ(board.enable(0b01), 0);
  ASSERT_EQ(board.target(0, 5000, 1000), 0);
  ASSERT_EQ(board.enable(0b11), 0);
  EXPECT_GT(board.servo.joint[0].ramp_left, 900);
  EXPECT_GT(board.servo.joint[0].command, 0);
}

TEST(Safety, SilenceOfTheHostSwitchesOffAfterTheWatchdogsTime) {
  TestBoard board;
  ASSERT_EQ(board.heartbeat(5), 0);
  ASSERT_EQ(board.enable(1), 0);
  board.send(KZ_TYPE_heartbeat, 77, {0, 0});
  board.tick();  // 12 bytes, heard in this tick
  for (int i = 0; i < 49; ++i) {
    board.tick();
    ASSERT_TRUE(board.drivers_on()) << i;
  }
  board.tick();
  EXPECT_TRUE(all_off(board.output));
  EXPECT_EQ(board.status(), KZ_SHUTDOWN_LINK_LOST << 8);  // latched
  EXPECT_EQ(board.enable(1), KZ_REFUSED_FAULT);
  ASSERT_EQ(board.clear(), 0);
  ASSERT_EQ(board.enable(1), 0);
  EXPECT_EQ(board.status(), KZ_STATUS_ENABLED);
}

TEST(Safety, TheDefaultOfTheWatchdogIs90Ms) {
  TestBoard board;
  board.send(KZ_TYPE_enable, 1, {0, 0, 0, 1});
  board.tick();
  ASSERT_TRUE(board.drivers_on());
  board.ticks(89);
  EXPECT_TRUE(board.drivers_on());
  board.tick();
  EXPECT_FALSE(board.drivers_on());
}

TEST(Safety, FramesForOtherBoardsDoNotFeedTheWatchdog) {
  TestBoard board;
  board.send(KZ_TYPE_enable, 1, {0, 0, 0, 1});
  board.tick();
  for (int i = 0; i < 200; ++i) {
    if (i % 20 == 0) board.send(KZ_TYPE_heartbeat, static_cast<u8>(i), {0, 0}, 7);
    board.tick();
  }
  EXPECT_FALSE(board.drivers_on());
}

TEST(Safety, ABadPotentiometerGetsNoPowerAndSwitchesAllOffAfter20Ms) {
  for (const u16 bad : {0, 3, 1020, 1023}) {
    TestBoard board;
    ASSERT_EQ(board.enable(0b11), 0);
    ASSERT_EQ(board.target(0, 10000, 10), 0);
    board.ticks(20);
    ASSERT_NE(board.output.pw[0], 0);
    board.set_pot(0, bad);
    for (int i = 0; i < 19; ++i) {
      board.tick();
      ASSERT_EQ(board.output.pw[0], 0);
      ASSERT_TRUE(board.drivers_on()) << i;
    }
    board.tick();
    EXPECT_TRUE(all_off(board.output));
    EXPECT_EQ(board.status(), KZ_SHUTDOWN_POT << 8);
    EXPECT_EQ(board.enable(0b11), KZ_REFUSED_FAULT);
    board.set_pot(0, 512);
    ASSERT_EQ(board.clear(), 0);
    EXPECT_EQ(board.enable(0b11), 0);
    EXPECT_EQ(board.status(), KZ_STATUS_ENABLED);
  }
}

TEST(Safety, ThePotentiometerOfAJointThatIsOffDoesNotMatter) {
  TestBoard board;
  ASSERT_EQ(board.enable(0b01), 0);
  board.set_pot(1, 0);
  board.ticks(50);
  EXPECT_TRUE(board.drivers_on());
}

TEST(Safety, SupplyOutOfRangeFor20MsSwitchesOff) {
  for (const u16 millivolts : {3900, 13200}) {
    TestBoard board;
    ASSERT_EQ(board.enable(1), 0);
    board.input.analog[KZ_ANALOG_SUPPLY] = static_cast<u16>(millivolts / 15);
    board.ticks(19);
    EXPECT_TRUE(board.drivers_on());
    board.tick();
    EXPECT_TRUE(all_off(board.output));
    EXPECT_EQ(board.status(),
              (millivolts < 5000 ? KZ_SHUTDOWN_UNDERVOLTAGE : KZ_SHUTDOWN_OVERVOLTAGE) << 8);
  }
}

TEST(Safety, DisableSwitchesTheDriversOffAtOnce) {
  TestBoard board;
  ASSERT_EQ(board.enable(kAllJoints), 0);
  board.send(KZ_TYPE_enable, 200, {0, 0, 0, 0});
  board.tick();
  EXPECT_TRUE(all_off(board.output));
}

TEST(Safety, WhateverComesNoCommandLeavesTheLimits) {
  std::mt19937 random(7);
  TestBoard board;
  board.tick();
  for (int i = 0; i < 20000; ++i) {
    if (random() % 4 == 0) {
      Bytes fields(random() % 50);
      for (u8& byte : fields) byte = static_cast<u8>(random());
      if (fields.size() >= 4) fields[0] = fields[1] = 0;
      board.send(static_cast<u8>(random() % 8), static_cast<u8>(random()), fields);
    }
    if (random() % 8 == 0) board.send(KZ_TYPE_enable, static_cast<u8>(random()), {0, 3, 255, 255});
    board.tick();
    for (int joint = 0; joint < KZ_JOINTS; ++joint) {
      if (!(board.servo.enabled >> joint & 1)) continue;
      ASSERT_GE(board.servo.joint[joint].command, kz_board_joints[joint].lower);
      ASSERT_LE(board.servo.joint[joint].command, kz_board_joints[joint].upper);
    }
  }
}

}  // namespace
}  // namespace kaz::test
