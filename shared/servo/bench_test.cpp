// Unlock, raw drive, and the actions between two ticks: address, reset, loader.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "shared/servo/board_testing.h"

namespace kaz::test {
namespace {

constexpr u8 kNeckPan = 0, kRShPitch = 6;
const Bytes kKey = {KZ_KEY >> 8, KZ_KEY & 0xFF};

bool driven(const TestBoard& board) {
  return board.output.pw[0] != 0;
}

TEST(Unlock, LastsForItsTime) {
  TestBoard board;
  ASSERT_EQ(board.unlock(2), 0);
  const u32 start = board.input.tick;
  EXPECT_EQ(board.status(), KZ_STATUS_UNLOCKED);
  while (board.servo.unlocked_ms != 0) board.tick();
  EXPECT_NEAR(board.input.tick - start, 2000, 3);
  EXPECT_EQ(board.raw_drive(0, 100, 100), KZ_REFUSED_LOCKED);
}

TEST(Unlock, ZeroLocksAgain) {
  TestBoard board;
  ASSERT_EQ(board.unlock(60), 0);
  ASSERT_EQ(board.unlock(0), 0);
  EXPECT_EQ(board.status(), 0);
  EXPECT_EQ(board.raw_drive(0, 100, 100), KZ_REFUSED_LOCKED);
}

TEST(Unlock, WantsTheKeyAndAllMotorsOff) {
  TestBoard board;
  EXPECT_EQ(board.unlock(10, KZ_KEY + 1), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 0);
  EXPECT_EQ(board.unlock(61), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 1);
  ASSERT_EQ(board.enable(1), 0);
  EXPECT_EQ(board.unlock(10), KZ_REFUSED_ARMED);
  EXPECT_EQ(board.status(), KZ_STATUS_ENABLED);
}

class RawDrive : public testing::Test {
 protected:
  RawDrive() { EXPECT_EQ(board.unlock(60), 0); }
  TestBoard board;
};

TEST_F(RawDrive, DrivesOneMotorForItsTime) {
  ASSERT_EQ(board.heartbeat(100), 0);
  board.send(KZ_TYPE_raw_drive, 200, {kNeckPan, 0, 120, 0, 50});
  while (board.servo.raw_ms == 0) board.tick();
  int ms = 0;
  for (int i = 0; i < 100; ++i) {
    board.tick();
    if (!board.drivers_on()) continue;
    ++ms;
    EXPECT_EQ(board.output.pw[0], 120);
    EXPECT_EQ(board.output.p3 & 1, 1);
    for (int other = 1; other < 16; ++other) EXPECT_EQ(board.output.pw[other], 0);
  }
  EXPECT_EQ(ms, 50);
  EXPECT_EQ(board.status(), KZ_STATUS_UNLOCKED);
}

TEST_F(RawDrive, SignIsThatOfTheJoint) {
  for (const s16 duty : {90, -90}) {
    ASSERT_EQ(board.raw_drive(kRShPitch, duty, 1000), 0);  // mirrored, on PW5 and P36
    board.ticks(2);
    EXPECT_EQ(board.output.pw[5], 90);
    EXPECT_EQ(board.output.p3 >> 6 & 1, duty < 0);
    EXPECT_EQ(board.joints(1u << kRShPitch).duty[kRShPitch], duty);
  }
  EXPECT_EQ(board.status(), KZ_STATUS_ENABLED | KZ_STATUS_RAW_DRIVE | KZ_STATUS_UNLOCKED);
}

TEST_F(RawDrive, AFurtherOneReplacesIt) {
  ASSERT_EQ(board.raw_drive(kNeckPan, 100, 1000), 0);
  board.ticks(2);
  ASSERT_TRUE(driven(board));
  ASSERT_EQ(board.raw_drive(kRShPitch, 100, 1000), 0);
  board.ticks(2);
  EXPECT_FALSE(driven(board));
  EXPECT_EQ(board.output.pw[5], 100);
}

TEST_F(RawDrive, EndsWithAllThatSwitchesMotorsOff) {
  using End = void (*)(TestBoard&);
  const End ends[] = {
      [](TestBoard& b) { EXPECT_EQ(b.raw_drive(kNeckPan, 0, 100), 0); },
      [](TestBoard& b) { EXPECT_EQ(b.enable(0), 0); },
      [](TestBoard& b) { EXPECT_EQ(b.enable(0b10), 0); },
      [](TestBoard& b) { EXPECT_EQ(b.stop(), 0); },
      [](TestBoard& b) { EXPECT_EQ(b.unlock(0), 0); },
      [](TestBoard& b) { b.ticks(91); },  // the link watchdog
      [](TestBoard& b) {
        b.input.analog[KZ_ANALOG_SUPPLY] = 0;
        b.ticks(25);
      },
  };
  for (const End end : ends) {
    board.~TestBoard();
    new (&board) TestBoard;
    ASSERT_EQ(board.unlock(60), 0);
    ASSERT_EQ(board.raw_drive(kNeckPan, 200, 2000), 0);
    board.ticks(2);
    ASSERT_TRUE(driven(board));
    end(board);
    EXPECT_FALSE(driven(board));
    board.ticks(50);
    EXPECT_FALSE(driven(board));
  }
}

TEST_F(RawDrive, TheLinkWatchdogSwitchesItOffWhateverTheReaction) {
  ASSERT_EQ(board.heartbeat(0, KZ_REACTION_HOLD), 0);
  ASSERT_EQ(board.raw_drive(kNeckPan, 200, 2000), 0);
  board.ticks(100);
  EXPECT_FALSE(board.drivers_on());
  EXPECT_EQ(board.status(), KZ_SHUTDOWN_LINK_LOST << 8 | KZ_STATUS_UNLOCKED);
}

TEST_F(RawDrive, EndsWithTheUnlocksTime) {
  ASSERT_EQ(board.heartbeat(100), 0);
  ASSERT_EQ(board.unlock(1), 0);
  board.ticks(900);
  ASSERT_EQ(board.raw_drive(kNeckPan, 200, 2000), 0);
  board.ticks(2);
  ASSERT_TRUE(driven(board));
  board.ticks(100);
  EXPECT_FALSE(driven(board));
  EXPECT_EQ(board.status(), 0);
}

TEST_F(RawDrive, DoesNotDriveFurtherOutAtASoftLimit) {
  ASSERT_EQ(board.limits(1, 60, -1000, 1000), 0);
  board.set_pot(kNeckPan, 560);  // 0.155 rad
  board.ticks(100);
  ASSERT_EQ(board.raw_drive(kNeckPan, 200, 1000), 0);
  board.ticks(3);
  EXPECT_FALSE(driven(board));
  ASSERT_EQ(board.raw_drive(kNeckPan, -200, 1000), 0);
  board.ticks(3);
  EXPECT_TRUE(driven(board));
}

TEST_F(RawDrive, ABadPotentiometerGetsNoPowerAndThenSwitchesOff) {
  ASSERT_EQ(board.raw_drive(kNeckPan, 200, 2000), 0);
  board.ticks(2);
  board.set_pot(kNeckPan, 0);
  board.tick();
  EXPECT_FALSE(driven(board));
  board.ticks(20);
  EXPECT_FALSE(board.drivers_on());
  const kz_health_reply health = board.health();
  EXPECT_EQ(health.status >> 8, KZ_SHUTDOWN_POT);
  EXPECT_EQ(health.detail, kNeckPan);
  EXPECT_EQ(board.raw_drive(kNeckPan, 200, 2000), KZ_REFUSED_FAULT);
  ASSERT_EQ(board.clear(), KZ_REFUSED_FAULT);
}

TEST_F(RawDrive, IsRefusedWhileAJointIsOnOrAFaultIsThere) {
  ASSERT_EQ(board.enable(0b10), 0);
  EXPECT_EQ(board.raw_drive(kNeckPan, 200, 100), KZ_REFUSED_ARMED);
  ASSERT_EQ(board.stop(), 0);
  EXPECT_EQ(board.raw_drive(kNeckPan, 200, 100), KZ_REFUSED_FAULT);
  EXPECT_EQ(board.detail, KZ_SHUTDOWN_STOP);
  ASSERT_EQ(board.clear(), 0);
  EXPECT_EQ(board.raw_drive(18, 200, 100), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.raw_drive(0, 256, 100), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.raw_drive(0, -256, 100), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.raw_drive(0, 10, 0), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.raw_drive(0, 10, 2001), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 2);
}

TEST_F(RawDrive, DutyZeroEndsItWhileAFaultIsThere) {
  ASSERT_EQ(board.raw_drive(kNeckPan, 100, 1000), 0);
  board.set_pot(kNeckPan, 0);
  board.ticks(5);
  EXPECT_EQ(board.raw_drive(kNeckPan, 100, 1000), KZ_REFUSED_FAULT);
  EXPECT_EQ(board.raw_drive(kNeckPan, 0, 1000), 0);
  EXPECT_FALSE(board.drivers_on());
}

TEST_F(RawDrive, TargetsDoNotMoveIt) {
  ASSERT_EQ(board.raw_drive(kNeckPan, 200, 1000), 0);
  EXPECT_EQ(board.target(kNeckPan, 100, 10), KZ_REFUSED_DISABLED);
}

TEST_F(RawDrive, CountsAsAMotorThatIsOn) {
  ASSERT_EQ(board.raw_drive(kNeckPan, 200, 2000), 0);
  EXPECT_EQ(board.outcome(KZ_TYPE_reset, kKey), KZ_REFUSED_ARMED);
  EXPECT_EQ(board.outcome(KZ_TYPE_loader, kKey), KZ_REFUSED_ARMED);
  EXPECT_EQ(board.outcome(KZ_TYPE_set_address, {3, 0}), KZ_REFUSED_ARMED);
  EXPECT_EQ(board.outcome(KZ_TYPE_store_calibration, {}), KZ_REFUSED_ARMED);
  kz_calibrate request = {};
  EXPECT_EQ(board.calibrate(request), KZ_REFUSED_ARMED);
  EXPECT_TRUE(board.actions.empty());
}

// ---- Actions

TEST(Action, ResetAndLoaderComeWhenTheirReplyHasLeft) {
  for (const auto& [type, action] :
       {std::pair{KZ_TYPE_reset, KZ_ACTION_RESET}, std::pair{KZ_TYPE_loader, KZ_ACTION_LOADER}}) {
    TestBoard board;
    board.send(static_cast<u8>(type), 9, kKey);
    board.send(KZ_TYPE_state, 10, {});  // too late
    board.input.tx_room = KZ_TX_BUFFER - 1;
    board.ticks(10);
    ASSERT_EQ(board.replies.size(), 2u);
    EXPECT_EQ(board.replies[0].type, type | KZ_REPLY);
    EXPECT_EQ(board.replies[1].type, KZ_TYPE_refused);  // BUSY
    EXPECT_TRUE(board.actions.empty());                 // bytes are still in the transmitter
    board.input.tx_room = KZ_TX_BUFFER;
    board.tick();
    ASSERT_EQ(board.actions.size(), 1u);
    EXPECT_EQ(board.actions[0], action);
    EXPECT_EQ(board.output.tx_count, 0);
    EXPECT_FALSE(board.drivers_on());
  }
}

TEST(Action, ResetAndLoaderWantTheKeyAndAllMotorsOff) {
  for (const u8 type : {KZ_TYPE_reset, KZ_TYPE_loader}) {
    TestBoard board;
    EXPECT_EQ(board.outcome(type, {0, 0}), KZ_REFUSED_RANGE);
    ASSERT_EQ(board.enable(1), 0);
    EXPECT_EQ(board.outcome(type, kKey), KZ_REFUSED_ARMED);
    board.ticks(20);
    EXPECT_TRUE(board.actions.empty());
    EXPECT_TRUE(board.drivers_on());
  }
}

TEST(Action, NothingIsSwitchedOnWhileOneIsAboutToBeDone) {
  TestBoard board;
  board.input.tx_room = 0;  // the reply waits
  board.send(KZ_TYPE_reset, 9, kKey);
  board.send(KZ_TYPE_enable, 10, {0, 0, 0, 1}, KZ_ADDRESS_ALL);
  board.send(KZ_TYPE_enable, 11, {0, 0, 0, 1});
  board.ticks(10);
  EXPECT_EQ(board.servo.enabled, 0u);
  board.input.tx_room = KZ_TX_BUFFER;
  board.ticks(10);
  EXPECT_EQ(board.actions.size(), 1u);
}

TEST(Action, SetAddressIsAnsweredWhenItIsStored) {
  TestBoard board;
  EXPECT_EQ(board.outcome(KZ_TYPE_set_address, {3, 1}), KZ_REFUSED_LOCKED);
  ASSERT_EQ(board.unlock(10), 0);
  EXPECT_EQ(board.outcome(KZ_TYPE_set_address, {0, 0}), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.outcome(KZ_TYPE_set_address, {15, 0}), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.outcome(KZ_TYPE_set_address, {3, 2}), KZ_REFUSED_RANGE);
  ASSERT_TRUE(board.actions.empty());
  EXPECT_EQ(board.outcome(KZ_TYPE_set_address, {3, 1}), 0);
  EXPECT_EQ(board.actions, std::vector<u8>{KZ_ACTION_STORE_ADDRESS});
  EXPECT_EQ(board.servo.new_address, 3);
  EXPECT_EQ(board.servo.new_shared_line, 1);
  EXPECT_EQ(board.servo.address, KZ_ADDRESS_DEFAULT);  // until the next reset
}

TEST(Action, AFailedWriteIsReported) {
  TestBoard board;
  board.action_result = KZ_RESULT_FAILED;
  ASSERT_EQ(board.unlock(10), 0);
  EXPECT_EQ(board.outcome(KZ_TYPE_set_address, {3, 0}), KZ_REFUSED_STORE);
  EXPECT_EQ(board.detail, 255);
  const u8 number = board.sequence;
  // Its repetition is refused the same way, without another write.
  board.replies.clear();
  board.send(KZ_TYPE_set_address, number, {3, 0});
  board.ticks(10);
  ASSERT_EQ(board.replies.size(), 1u);
  EXPECT_EQ(board.replies[0].type, KZ_TYPE_refused);
  EXPECT_EQ(board.actions.size(), 1u);
}

TEST(Action, ForAllBoardsIsDoneWithoutAReply) {
  TestBoard board;
  board.send(KZ_TYPE_reset, 1, kKey, KZ_ADDRESS_ALL);
  board.ticks(5);
  EXPECT_EQ(board.actions, std::vector<u8>{KZ_ACTION_RESET});
  EXPECT_TRUE(board.replies.empty());
}

}  // namespace
}  // namespace kaz::test
