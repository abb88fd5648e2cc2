// Reasons that switch motors off: each latched, reported, and cleared only when its cause is gone.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>

#include "shared/servo/board_testing.h"

namespace kaz::test {
namespace {

struct Cause {
  const char* name;
  u8 reason;
  u8 detail;
  int within_ms;
  std::function<void(TestBoard&)> make;  // what is wrong, with joints 0 and 1 on
  std::function<void(TestBoard&)> mend;
};

std::function<void(TestBoard&)> reads(int input, u16 code) {
  return [=](TestBoard& board) { board.input.analog[input] = code; };
}

std::vector<Cause> causes() {
  const int pot = kz_board_joints[1].analog;
  return {
      {"pot", KZ_SHUTDOWN_POT, 1, 20, reads(pot, 0), reads(pot, 512)},
      {"undervoltage", KZ_SHUTDOWN_UNDERVOLTAGE, 255, 24, reads(KZ_ANALOG_SUPPLY, 266),
       reads(KZ_ANALOG_SUPPLY, 267)},
      {"overvoltage", KZ_SHUTDOWN_OVERVOLTAGE, 255, 24, reads(KZ_ANALOG_SUPPLY, 867),
       reads(KZ_ANALOG_SUPPLY, 866)},
      {"temperature", KZ_SHUTDOWN_TEMPERATURE, 255, 24, reads(KZ_ANALOG_TEMPERATURE, 851),
       reads(KZ_ANALOG_TEMPERATURE, 850)},
      {"reference low", KZ_SHUTDOWN_REFERENCE, 255, 24, reads(KZ_ANALOG_REFERENCE, 495),
       reads(KZ_ANALOG_REFERENCE, 496)},
      {"reference high", KZ_SHUTDOWN_REFERENCE, 255, 24, reads(KZ_ANALOG_REFERENCE, 529),
       reads(KZ_ANALOG_REFERENCE, 528)},
  };
}

TEST(Shutdown, LatchesReasonJointAndTickUntilTheCauseIsGone) {
  for (const Cause& cause : causes()) {
    SCOPED_TRACE(cause.name);
    TestBoard board;
    ASSERT_EQ(board.enable(0b11), 0);
    cause.make(board);
    int ms = 0;
    while (board.drivers_on() && ms < 50) {
      board.tick();
      ++ms;
    }
    EXPECT_GE(ms, 17);
    EXPECT_LE(ms, cause.within_ms);
    const u32 at = board.input.tick - 1;
    const kz_health_reply health = board.health();
    EXPECT_EQ(health.status, cause.reason << 8);
    EXPECT_EQ(health.detail, cause.detail);
    EXPECT_EQ(health.shutdown_tick, at);

    EXPECT_EQ(board.enable(0b11), KZ_REFUSED_FAULT);
    EXPECT_EQ(board.detail, cause.reason);
    EXPECT_EQ(board.target(0, 0, 0), KZ_REFUSED_FAULT);
    EXPECT_EQ(board.clear(), KZ_REFUSED_FAULT);
    EXPECT_EQ(board.detail, cause.reason);
    EXPECT_EQ(board.enable(0), 0);  // nothing to switch on

    cause.mend(board);
    board.ticks(4);
    EXPECT_EQ(board.enable(0b11), KZ_REFUSED_FAULT);  // still latched
    EXPECT_EQ(board.clear(), 0);
    EXPECT_FALSE(board.drivers_on());
    const kz_health_reply after = board.health();
    EXPECT_EQ(after.status, 0);
    EXPECT_EQ(after.detail, 255);
    EXPECT_EQ(after.shutdown_tick, 0u);
    EXPECT_EQ(board.enable(0b11), 0);
    EXPECT_TRUE(board.drivers_on());
  }
}

TEST(Shutdown, WhileMotorsAreOffNothingIsLatchedButNothingIsSwitchedOn) {
  for (const Cause& cause : causes()) {
    SCOPED_TRACE(cause.name);
    TestBoard board;
    cause.make(board);
    board.ticks(100);
    EXPECT_EQ(board.status(), 0);
    EXPECT_EQ(board.enable(0b11), KZ_REFUSED_FAULT);
    EXPECT_EQ(board.detail, cause.reason);
    cause.mend(board);
    board.ticks(4);
    EXPECT_EQ(board.enable(0b11), 0);
  }
}

TEST(Shutdown, AShortDisturbanceIsNone) {
  for (const Cause& cause : causes()) {
    SCOPED_TRACE(cause.name);
    TestBoard board;
    ASSERT_EQ(board.enable(0b11), 0);
    for (int i = 0; i < 4; ++i) {
      cause.make(board);
      board.ticks(15);
      cause.mend(board);
      board.ticks(5);
    }
    EXPECT_TRUE(board.drivers_on());
  }
}

TEST(Shutdown, OnlyTheFirstReasonIsKept) {
  TestBoard board;
  ASSERT_EQ(board.enable(0b11), 0);
  board.set_pot(1, 0);
  board.ticks(30);
  const u32 at = board.health().shutdown_tick;
  ASSERT_EQ(board.stop(), 0);
  board.input.analog[KZ_ANALOG_SUPPLY] = 0;
  board.ticks(200);
  const kz_health_reply health = board.health();
  EXPECT_EQ(health.status >> 8, KZ_SHUTDOWN_POT);
  EXPECT_EQ(health.shutdown_tick, at);
}

TEST(Shutdown, StopIsLatchedWithMotorsOnOrOff) {
  for (const bool on : {false, true}) {
    TestBoard board;
    if (on) {
      ASSERT_EQ(board.enable(0b11), 0);
    }
    ASSERT_EQ(board.stop(), 0);
    EXPECT_FALSE(board.drivers_on());
    EXPECT_EQ(board.status(), KZ_SHUTDOWN_STOP << 8);
    EXPECT_EQ(board.enable(1), KZ_REFUSED_FAULT);
    EXPECT_EQ(board.detail, KZ_SHUTDOWN_STOP);
    EXPECT_EQ(board.clear(), 0);
    EXPECT_EQ(board.enable(1), 0);
  }
}

TEST(Shutdown, StopWorksForAllBoards) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  board.send(KZ_TYPE_stop, 1, {}, KZ_ADDRESS_ALL);
  board.tick();
  EXPECT_FALSE(board.drivers_on());
  EXPECT_EQ(board.status(), KZ_SHUTDOWN_STOP << 8);
}

TEST(Shutdown, AFailedSelfTestStaysUntilAReset) {
  kz_startup startup = TestBoard::valid_startup();
  startup.tests_done = 15;
  startup.tests_failed = KZ_TEST_FLASH;
  TestBoard board(startup);
  EXPECT_EQ(board.self_test().failed, KZ_TEST_FLASH);
  EXPECT_EQ(board.status(), KZ_SHUTDOWN_SELF_TEST << 8);
  EXPECT_EQ(board.enable(1), KZ_REFUSED_FAULT);
  EXPECT_EQ(board.clear(), KZ_REFUSED_FAULT);
  EXPECT_EQ(board.detail, KZ_SHUTDOWN_SELF_TEST);
  EXPECT_EQ(board.unlock(10), 0);
  EXPECT_EQ(board.raw_drive(0, 100, 100), KZ_REFUSED_FAULT);
}

TEST(Shutdown, InformationIsGivenWhateverIsLatched) {
  TestBoard board;
  ASSERT_EQ(board.stop(), 0);
  for (const u8 type : {KZ_TYPE_identify, KZ_TYPE_state, KZ_TYPE_health, KZ_TYPE_statistics,
                        KZ_TYPE_self_test, KZ_TYPE_calibration, KZ_TYPE_heartbeat}) {
    EXPECT_EQ(board.outcome(type, type == KZ_TYPE_heartbeat ? Bytes{0, 0} : Bytes{}), 0);
  }
}

TEST(Shutdown, MissedTicksAreReportedUntilClearButThoseOfFlashAreNot) {
  TestBoard board;
  board.input.missed = 2500;
  board.input.result = KZ_RESULT_DONE;
  board.tick();
  board.input.missed = 0;
  EXPECT_EQ(board.status(), 0);
  board.input.missed = 2;
  board.tick();
  board.input.missed = 0;
  EXPECT_EQ(board.status(), KZ_STATUS_MISSED_TICK);
  EXPECT_EQ(board.statistics().missed_ticks, 2);
  EXPECT_EQ(board.clear(), 0);
  EXPECT_EQ(board.status(), 0);
}

// ---- The link watchdog

class Watchdog : public testing::Test {
 protected:
  void start(u8 reaction) {
    ASSERT_EQ(board.heartbeat(5, reaction), 0);
    ASSERT_EQ(board.enable(0b11), 0);
    ASSERT_EQ(board.gains(1, 0, 0), 0);  // this joint never moves: it would count as stalled
    ASSERT_EQ(board.target(0, 5000, 200), 0);
  }
  TestBoard board;
};

TEST_F(Watchdog, HoldKeepsTheMotorsOnAndTheCommandsWhereTheyAre) {
  start(KZ_REACTION_HOLD);
  board.ticks(48);
  const s16 before = board.servo.joint[0].command;
  board.ticks(5);
  const s16 held = board.servo.joint[0].command;
  EXPECT_GT(held, before - 1);
  EXPECT_LE(held, before + 5 * 25);
  board.ticks(1000);
  EXPECT_TRUE(board.drivers_on());
  EXPECT_EQ(board.servo.joint[0].command, held);
  EXPECT_EQ(board.status(), KZ_SHUTDOWN_LINK_LOST << 8 | KZ_STATUS_ENABLED | KZ_STATUS_HOLDING);
  EXPECT_EQ(board.target(0, 0, 0), KZ_REFUSED_FAULT);
  EXPECT_EQ(board.detail, KZ_SHUTDOWN_LINK_LOST);
  EXPECT_EQ(board.enable(0b1), KZ_REFUSED_FAULT);
  EXPECT_EQ(board.read_targets(1).angle[0], held);
}

TEST_F(Watchdog, ClearLetsGoOfWhatItHolds) {
  start(KZ_REACTION_HOLD);
  board.ticks(60);
  ASSERT_EQ(board.clear(), 0);
  EXPECT_FALSE(board.drivers_on());
  EXPECT_EQ(board.status(), 0);
  board.set_pot(0, 560);
  board.ticks(2);
  ASSERT_EQ(board.enable(0b11), 0);
  EXPECT_EQ(board.servo.joint[0].command, kz_pot_angle(&kz_board_joints[0], 560));
}

TEST_F(Watchdog, WhatElseHappensWhileHoldingSwitchesOff) {
  for (int what = 0; what < 3; ++what) {
    board.~TestBoard();
    new (&board) TestBoard;
    start(KZ_REACTION_HOLD);
    board.ticks(60);
    ASSERT_TRUE(board.drivers_on());
    if (what == 0) board.set_pot(1, 0);
    if (what == 1) board.input.analog[KZ_ANALOG_SUPPLY] = 0;
    if (what == 2) {
      ASSERT_EQ(board.stop(), 0);
    }
    board.ticks(30);
    EXPECT_FALSE(board.drivers_on()) << what;
    EXPECT_EQ(board.status(), KZ_SHUTDOWN_LINK_LOST << 8) << what;  // the first reason
  }
}

TEST_F(Watchdog, AnEmptyEnableLetsGoButClearsNothing) {
  start(KZ_REACTION_HOLD);
  board.ticks(60);
  ASSERT_EQ(board.enable(0), 0);
  EXPECT_EQ(board.status(), KZ_SHUTDOWN_LINK_LOST << 8);
}

TEST_F(Watchdog, TheReactionIsChosenByHeartbeatAndKept) {
  ASSERT_EQ(board.heartbeat(0, KZ_REACTION_HOLD), 0);
  ASSERT_EQ(board.heartbeat(7, 0), 0);
  EXPECT_EQ(board.servo.reaction, KZ_REACTION_HOLD);
  EXPECT_EQ(board.servo.watchdog_ms, 70);
  ASSERT_EQ(board.heartbeat(0, KZ_REACTION_LIMP), 0);
  EXPECT_EQ(board.servo.reaction, KZ_REACTION_LIMP);
  EXPECT_EQ(board.servo.watchdog_ms, 70);
  EXPECT_EQ(board.heartbeat(0, 3), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 1);
}

TEST_F(Watchdog, WithMotorsOffSilenceIsNoFault) {
  board.ticks(2000);
  EXPECT_EQ(board.status(), 0);
  EXPECT_EQ(board.enable(1), 0);
}

TEST_F(Watchdog, DamagedFramesAndRepliesDoNotFeedIt) {
  start(KZ_REACTION_LIMP);
  for (int i = 0; i < 50; ++i) {
    if (i % 10 == 0) board.put_on_wire({0, 4, 1, 5, 5, 0x83, 0xAC, 0xD2, 0});  // bad check
    if (i % 10 == 5) board.send(KZ_TYPE_state_reply, 1, Bytes(KZ_SIZE_state_reply));
    board.tick();
  }
  EXPECT_FALSE(board.drivers_on());
}

TEST_F(Watchdog, TimeGoesOnInMissedTicks) {
  start(KZ_REACTION_LIMP);
  board.input.missed = 49;
  board.tick();
  EXPECT_FALSE(board.drivers_on());
}

}  // namespace
}  // namespace kaz::test
