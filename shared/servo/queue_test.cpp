// Several requests under way, and requests that come twice.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "shared/servo/board_testing.h"

namespace kaz::test {
namespace {

std::vector<int> sequences(const TestBoard& board) {
  std::vector<int> result;
  for (const Reply& reply : board.replies) result.push_back(reply.sequence);
  return result;
}

kz_refused refusal(const Reply& reply) {
  EXPECT_EQ(reply.type, KZ_TYPE_refused);
  return fields_of<kz_refused, kz_unpack_refused>(reply);
}

// The fields of a request for one joint's target.
Bytes to(s16 angle, u16 duration_ms) {
  kz_targets request = {};
  request.mask = 1;
  request.duration_ms = duration_ms;
  request.angle[0] = angle;
  Bytes fields(KZ_SIZE_targets);
  fields.resize(kz_pack_targets(&request, fields.data()));
  return fields;
}

TEST(Queue, ASecondRequestWaitsForTheReplyToTheFirst) {
  TestBoard board;
  board.send(KZ_TYPE_state, 1, {});
  board.send(KZ_TYPE_identify, 2, {});
  board.ticks(20);
  ASSERT_EQ(sequences(board), (std::vector{1, 2}));
  EXPECT_EQ(board.replies[0].type, KZ_TYPE_state_reply);
  EXPECT_EQ(board.replies[1].type, KZ_TYPE_identify_reply);
}

TEST(Queue, TheLastOfThoseTooManyIsRefusedWhenTheWireIsFree) {
  TestBoard board;
  board.send(KZ_TYPE_state, 1, {});
  board.send(KZ_TYPE_state, 2, {});
  board.send(KZ_TYPE_enable, 3, {0, 0, 0, 1});
  board.send(KZ_TYPE_identify, 4, {});
  board.ticks(30);
  ASSERT_EQ(sequences(board), (std::vector{1, 2, 4}));
  const kz_refused refused = refusal(board.replies[2]);
  EXPECT_EQ(refused.reason, KZ_REFUSED_BUSY);
  EXPECT_EQ(refused.detail, 255);
  EXPECT_EQ(refused.request, KZ_TYPE_identify);
  EXPECT_EQ(board.servo.enabled, 0u);
  EXPECT_EQ(board.statistics().refusals, 2);
  // It was not done, so it is no repetition when it comes again.
  board.replies.clear();
  board.send(KZ_TYPE_enable, 3, {0, 0, 0, 1});
  board.ticks(10);
  EXPECT_EQ(board.servo.enabled, 1u);
}

TEST(Queue, AReplyDescribesTheTickInWhichItIsMade) {
  TestBoard board;
  board.send(KZ_TYPE_state, 1, {});
  board.send(KZ_TYPE_state, 2, {});
  board.ticks(20);
  ASSERT_EQ(board.replies.size(), 2u);
  const auto first = fields_of<kz_state_reply, kz_unpack_state_reply>(board.replies[0]);
  const auto second = fields_of<kz_state_reply, kz_unpack_state_reply>(board.replies[1]);
  EXPECT_GE(second.tick, first.tick + 4);  // 53 bytes, 16 a tick
}

TEST(Queue, StopIsDoneAtOnceAndAnsweredInItsTurn) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  board.replies.clear();
  board.input.tx_room = 0;
  board.send(KZ_TYPE_state, 101, {});
  board.send(KZ_TYPE_state, 102, {});
  board.send(KZ_TYPE_state, 103, {});
  board.ticks(2);
  ASSERT_TRUE(board.drivers_on());
  board.send(KZ_TYPE_stop, 104, {});
  board.tick();
  EXPECT_FALSE(board.drivers_on());
  board.input.tx_room = 63;
  board.ticks(30);
  ASSERT_EQ(sequences(board), (std::vector{101, 102, 104, 103}));
  EXPECT_EQ(board.replies[2].type, KZ_TYPE_stop_reply);
  EXPECT_EQ(refusal(board.replies[3]).reason, KZ_REFUSED_BUSY);
}

TEST(Queue, HoweverManyStopsTheQueueHoldsAndTheLastIsAnswered) {
  TestBoard board;
  board.input.tx_room = 0;
  board.send(KZ_TYPE_state, 1, {});
  for (u8 i = 2; i < 60; ++i) board.send(KZ_TYPE_stop, i, {});
  board.ticks(60);
  board.input.tx_room = 63;
  board.ticks(60);
  EXPECT_EQ(sequences(board), (std::vector{1, 2, 59}));
}

TEST(Queue, ARequestToAllIsDoneHoweverManyAreUnderWay) {
  TestBoard board;
  board.input.tx_room = 0;
  for (u8 i = 1; i < 4; ++i) board.send(KZ_TYPE_state, i, {});
  board.send(KZ_TYPE_enable, 4, {0, 0, 0, 1}, KZ_ADDRESS_ALL);
  board.ticks(5);
  EXPECT_EQ(board.servo.enabled, 1u);
  board.input.tx_room = 63;
  board.ticks(40);
  EXPECT_EQ(sequences(board), (std::vector{1, 2, 3}));
}

TEST(Repetition, IsAnsweredButNotDoneTwice) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  ASSERT_EQ(board.target(0, 5000, 1000), 0);
  board.tick();
  const u16 left = board.servo.joint[0].ramp_left;
  board.replies.clear();
  board.send(KZ_TYPE_targets, board.sequence, to(5000, 1000));
  board.ticks(10);
  ASSERT_EQ(board.replies.size(), 1u);
  EXPECT_EQ(board.replies[0].type, KZ_TYPE_targets_reply);
  EXPECT_EQ(board.servo.joint[0].ramp_left, left - 10);  // had it been done again: about 1000
  EXPECT_EQ(board.statistics().repetitions, 1);
}

TEST(Repetition, IsRecognisedAmongTheLastFourRequests) {
  for (int others = 0; others < 6; ++others) {
    TestBoard board;
    ASSERT_EQ(board.enable(1), 0);
    ASSERT_EQ(board.target(0, 5000, 1000), 0);
    const u8 number = board.sequence;
    for (int i = 0; i < others; ++i) ASSERT_EQ(board.heartbeat(), 0);
    board.send(KZ_TYPE_targets, number, to(5000, 1000));
    board.ticks(10);
    EXPECT_EQ(board.statistics().repetitions, others < 4) << others;
  }
}

TEST(Repetition, HasAFreshReplyAboutTheSame) {
  TestBoard board;
  const Bytes mask = {0, 0, 0, 0b101};
  ASSERT_TRUE(board.exchange(KZ_TYPE_read_targets, mask));
  const u8 number = board.sequence;
  ASSERT_EQ(board.heartbeat(), 0);
  board.set_pot(2, 600);
  board.replies.clear();
  board.send(KZ_TYPE_read_targets, number, mask);
  board.ticks(10);
  ASSERT_EQ(board.replies.size(), 1u);
  const auto reply =
      fields_of<kz_read_targets_reply, kz_unpack_read_targets_reply>(board.replies[0]);
  EXPECT_EQ(reply.mask, 0b101u);
  EXPECT_EQ(reply.angle[2], kz_pot_angle(&kz_board_joints[2], 600));
}

TEST(Repetition, OfARefusedRequestIsRefusedAgain) {
  TestBoard board;
  ASSERT_EQ(board.target(0, 0, 0), KZ_REFUSED_DISABLED);
  const u8 number = board.sequence;
  ASSERT_EQ(board.enable(1), 0);
  board.replies.clear();
  board.send(KZ_TYPE_targets, number, to(0, 0));
  board.ticks(10);
  ASSERT_EQ(board.replies.size(), 1u);
  EXPECT_EQ(refusal(board.replies[0]).reason, KZ_REFUSED_DISABLED);
}

TEST(Repetition, TheSameNumberWithOtherContentsIsANewRequest) {
  TestBoard board;
  ASSERT_EQ(board.enable(0b01), 0);
  board.send(KZ_TYPE_enable, board.sequence, {0, 0, 0, 0b10});
  board.ticks(10);
  EXPECT_EQ(board.servo.enabled, 0b10u);
}

TEST(Repetition, OfARequestToAllIsNotDoneAgain) {
  TestBoard board;
  board.send(KZ_TYPE_enable, 9, {0, 0, 0, 1}, KZ_ADDRESS_ALL);
  board.ticks(3);
  ASSERT_EQ(board.enable(0), 0);
  board.send(KZ_TYPE_enable, 9, {0, 0, 0, 1}, KZ_ADDRESS_ALL);
  board.ticks(3);
  EXPECT_EQ(board.servo.enabled, 0u);
  // To one board it is another request.
  board.send(KZ_TYPE_enable, 9, {0, 0, 0, 1});
  board.ticks(3);
  EXPECT_EQ(board.servo.enabled, 1u);
}

// Sends the same bytes a second time, after `between`.
template <class Between>
void repeat(TestBoard& board, u8 type, const Bytes& fields, Between between,
            u8 address = KZ_ADDRESS_DEFAULT) {
  constexpr u8 number = 200;
  board.send(type, number, fields, address);
  board.ticks(10);
  between();
  board.replies.clear();
  board.send(type, number, fields, address);
  board.ticks(10);
}

TEST(Repetition, OfStopStops) {
  for (const u8 address : {KZ_ADDRESS_DEFAULT, KZ_ADDRESS_ALL}) {
    TestBoard board;
    repeat(
        board, KZ_TYPE_stop, {},
        [&] {
          ASSERT_EQ(board.clear(), 0);
          ASSERT_EQ(board.enable(1), 0);
        },
        address);
    EXPECT_FALSE(board.drivers_on());
    EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_STOP);
    EXPECT_EQ(board.replies.size(), address == KZ_ADDRESS_ALL ? 0u : 1u);
    EXPECT_EQ(board.statistics().repetitions, 0);
  }
}

TEST(Repetition, OfEnableSwitchesOffOnly) {
  TestBoard board;
  repeat(board, KZ_TYPE_enable, {0, 0, 0, 0b101}, [&] { ASSERT_EQ(board.enable(0b011), 0); });
  EXPECT_EQ(board.servo.enabled, 0b001u);
  ASSERT_EQ(board.replies.size(), 1u);
  EXPECT_EQ((fields_of<kz_enable_reply, kz_unpack_enable_reply>(board.replies[0]).mask), 0b001u);
  repeat(board, KZ_TYPE_enable, {0, 0, 0, 0}, [&] { ASSERT_EQ(board.enable(0b011), 0); });
  EXPECT_FALSE(board.drivers_on());
}

// Its first transmission was refused, and the repetition says so: nothing of it is executed.
TEST(Repetition, OfARefusedEnableSwitchesNothingOff) {
  TestBoard board;
  ASSERT_EQ(board.stop(), 0);
  repeat(board, KZ_TYPE_enable, {0, 0, 0, 0b01}, [&] {
    ASSERT_EQ(board.clear(), 0);
    ASSERT_EQ(board.enable(0b10), 0);
  });
  ASSERT_EQ(board.replies.size(), 1u);
  EXPECT_EQ(refusal(board.replies[0]).reason, KZ_REFUSED_FAULT);
  EXPECT_EQ(board.servo.enabled, 0b10u);
}

TEST(Repetition, OfClearSwitchesOffWhatIsHeld) {
  TestBoard board;
  ASSERT_EQ(board.heartbeat(9, KZ_REACTION_HOLD), 0);
  repeat(board, KZ_TYPE_clear, {}, [&] {
    ASSERT_EQ(board.enable(1), 0);
    board.ticks(100);
    ASSERT_TRUE(board.servo.holding);
  });
  EXPECT_FALSE(board.servo.holding);
  EXPECT_FALSE(board.drivers_on());
  EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_LINK_LOST);
}

TEST(Repetition, OfALockOrARawDriveEndsTheRawDrive) {
  const auto raw = [](u8 joint, s16 duty) {
    return Bytes{joint, static_cast<u8>(duty >> 8), static_cast<u8>(duty), 0, 200};
  };
  const struct {
    u8 type;
    Bytes fields;
    bool ends;
  } all[] = {{KZ_TYPE_unlock, {KZ_KEY >> 8, KZ_KEY & 0xFF, 0}, true},
             {KZ_TYPE_unlock, {KZ_KEY >> 8, KZ_KEY & 0xFF, 30}, false},
             {KZ_TYPE_raw_drive, raw(0, 0), true},
             {KZ_TYPE_raw_drive, raw(1, -40), true},
             {KZ_TYPE_raw_drive, raw(0, -40), false}};
  for (const auto& one : all) {
    TestBoard board;
    ASSERT_EQ(board.unlock(10), 0);
    repeat(board, one.type, one.fields, [&] {
      board.unlock(10);  // refused while the first one drives, and not needed
      ASSERT_EQ(board.raw_drive(0, 50, 300), 0);
    });
    EXPECT_EQ(board.servo.raw_ms == 0, one.ends) << int(one.type) << " " << int(one.fields[2]);
    EXPECT_EQ(board.drivers_on(), !one.ends);
  }
}

}  // namespace
}  // namespace kaz::test
