// What the board answers: replies, refusals, addresses.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "shared/servo/board_testing.h"
#include "shared/servo/handlers.h"

namespace kaz::test {
namespace {

constexpr u32 kAllJoints = (1u << KZ_JOINTS) - 1;

TEST(Requests, IdentifyReportsWhatTheBoardIs) {
  kz_startup startup;
  kz_startup_nominal(&startup);
  startup.image_crc = 0xABCD;
  startup.reset_cause = KZ_RESET_WATCHDOG;
  TestBoard board;
  kz_servo_init(&board.servo, &startup, &board.output);
  board.input.tick = 100000;
  const auto reply = board.exchange(KZ_TYPE_identify, {});
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->address, KZ_ADDRESS_DEFAULT);
  EXPECT_EQ(reply->type, KZ_TYPE_identify_reply);
  EXPECT_EQ(reply->sequence, board.sequence);
  const auto identity = fields_of<kz_identify_reply, kz_unpack_identify_reply>(*reply);
  EXPECT_EQ(identity.protocol_version, KZ_PROTOCOL_VERSION);
  EXPECT_EQ(identity.joints, 18);
  EXPECT_EQ(identity.image_crc, 0xABCD);
  EXPECT_EQ(identity.reset_cause, KZ_RESET_WATCHDOG);
  EXPECT_EQ(identity.watchdog_10ms, 9);
  EXPECT_EQ(identity.reaction, KZ_REACTION_LIMP);
  EXPECT_GE(identity.tick, 100000u);
}

TEST(Requests, StateReplyHasTheAnglesAndTheTickOfTheirMeasurement) {
  TestBoard board;
  const u32 tick = board.input.tick;
  board.send(KZ_TYPE_state, 9, {});
  board.tick();  // all 9 bytes of the request come in this tick
  board.set_pot(0, 1000);
  board.ticks(10);
  ASSERT_EQ(board.replies.size(), 1u);
  const auto state = fields_of<kz_state_reply, kz_unpack_state_reply>(board.replies[0]);
  EXPECT_EQ(state.tick, tick);
  EXPECT_EQ(state.angle[0], kz_board_joints[0].pot_centre);  // code 512
  EXPECT_EQ(state.supply_mv, 667 * 15);
}

TEST(Requests, StatisticsCountTicksAndDamagedFrames) {
  TestBoard board;
  board.input.busy_8states = 800;
  board.input.worst_8states = 900;
  board.input.missed = 3;
  board.tick();
  board.input.missed = 0;
  board.put_on_wire({0, 1, 2, 3, 4, 5, 6, 7, 8, 0});  // no valid frame
  const auto reply = board.exchange(KZ_TYPE_statistics, {});
  ASSERT_TRUE(reply);
  const auto health = fields_of<kz_statistics_reply, kz_unpack_statistics_reply>(*reply);
  EXPECT_EQ(health.busy_8states, 800);
  EXPECT_EQ(health.worst_8states, 900);
  EXPECT_EQ(health.missed_ticks, 3);
  EXPECT_EQ(health.bad_check, 1);
  EXPECT_EQ(health.status, KZ_STATUS_MISSED_TICK);
}

TEST(Requests, RefusesAnUnknownType) {
  TestBoard board;
  EXPECT_EQ(board.outcome(0x55, {1, 2}), KZ_REFUSED_UNKNOWN_TYPE);
  EXPECT_EQ(board.detail, 255);
}

TEST(Requests, RefusesAWrongLength) {
  TestBoard board;
  EXPECT_EQ(board.outcome(KZ_TYPE_state, {0}), KZ_REFUSED_LENGTH);
  EXPECT_EQ(board.outcome(KZ_TYPE_enable, {0, 0, 1}), KZ_REFUSED_LENGTH);
  EXPECT_EQ(board.outcome(KZ_TYPE_targets, {0, 0, 0, 1, 0, 0, 0}), KZ_REFUSED_LENGTH);
  EXPECT_EQ(board.outcome(KZ_TYPE_targets, {0, 0, 0, 1, 0, 0, 0, 0, 0}), KZ_REFUSED_LENGTH);
}

TEST(Requests, RefusesAJointThatDoesNotExist) {
  TestBoard board;
  EXPECT_EQ(board.enable(1u << 20), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 0);  // the field `mask`
  EXPECT_EQ(board.gains(1u << 18, 100, 0), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 0);
}

TEST(Requests, RefusesARampOfZeroAndATooLongWatchdog) {
  TestBoard board;
  EXPECT_EQ(board.limits(1, 0), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 1);
  EXPECT_EQ(board.heartbeat(101), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.heartbeat(100), 0);
}

TEST(Requests, RefusesATargetOutsideTheLimitsAsAWhole) {
  TestBoard board;
  ASSERT_EQ(board.enable(0b11), 0);
  kz_targets request = {};
  request.mask = 0b11;
  request.angle[0] = 100;
  request.angle[1] = static_cast<s16>(kz_board_joints[1].upper + 1);
  EXPECT_EQ(board.targets(request), KZ_REFUSED_LIMIT);
  EXPECT_EQ(board.detail, 1);
  EXPECT_EQ(board.servo.joint[0].ramp_left, 0);  // nothing of it was done
  EXPECT_EQ(board.servo.joint[0].command, kz_board_joints[0].pot_centre);
  request.angle[1] = kz_board_joints[1].upper;
  EXPECT_EQ(board.targets(request), 0);
  request.angle[0] = static_cast<s16>(kz_board_joints[0].lower - 1);
  EXPECT_EQ(board.targets(request), KZ_REFUSED_LIMIT);
  EXPECT_EQ(board.detail, 0);
}

TEST(Requests, ARampThatWouldLeaveNarrowerLimitsEndsAtThem) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  kz_targets request = {};
  request.mask = 1;
  request.angle[0] = 3000;
  request.duration_ms = 1000;
  ASSERT_EQ(board.targets(request), 0);
  kz_limits limits = {};
  limits.mask = 3;
  limits.ramp = 60;
  limits.lower = -1000;
  limits.upper = 1000;
  kz_joint& joint = board.servo.joint[0];
  for (int i = 0; i < 10; ++i) board.tick();
  ASSERT_GT(joint.ramp_left, 900);
  ASSERT_EQ(kz_do_limits(&board.servo, &limits), KZ_DONE);
  int highest = 0;
  for (int i = 0; i < 500; ++i) {
    if (i % 40 == 0) board.heartbeat(0);
    board.tick();
    highest = std::max<int>(highest, joint.command);
  }
  EXPECT_EQ(highest, 1000);
  EXPECT_EQ(joint.target, 1000);
  EXPECT_EQ(joint.ramp_left, 0);
}

TEST(Requests, RefusesATargetForAJointThatIsOff) {
  TestBoard board;
  ASSERT_EQ(board.enable(0b10111), 0);
  kz_targets request = {};
  request.mask = 0b11111;
  for (int i = 0; i < 5; ++i)
    request.angle[i] = static_cast<s16>((kz_board_joints[i].lower + kz_board_joints[i].upper) / 2);
  EXPECT_EQ(board.targets(request), KZ_REFUSED_DISABLED);
  EXPECT_EQ(board.detail, 3);
}

TEST(Requests, RefusesToEnableWhileAFaultIsPresent) {
  TestBoard board;
  board.set_pot(7, 0);
  EXPECT_EQ(board.enable(kAllJoints), KZ_REFUSED_FAULT);
  EXPECT_EQ(board.detail, KZ_SHUTDOWN_POT);
  EXPECT_EQ(board.enable(0b1), 0);  // the other joints have no fault
  board.enable(0);
  board.input.analog[KZ_ANALOG_SUPPLY] = 100;  // 1.5 V
  board.ticks(4);
  EXPECT_EQ(board.enable(0b1), KZ_REFUSED_FAULT);
  EXPECT_EQ(board.detail, KZ_SHUTDOWN_UNDERVOLTAGE);
  EXPECT_FALSE(board.drivers_on());
}

TEST(Requests, OtherAddressesAreNotHeardAndAllIsNotAnswered) {
  TestBoard board;
  EXPECT_FALSE(board.exchange(KZ_TYPE_enable, {0, 0, 0, 1}, KZ_ADDRESS_DEFAULT + 1));
  EXPECT_EQ(board.servo.enabled, 0u);
  EXPECT_FALSE(board.exchange(KZ_TYPE_enable, {0, 0, 0, 1}, KZ_ADDRESS_ALL));
  EXPECT_EQ(board.servo.enabled, 1u);
}

TEST(Requests, RepliesOfOthersAreNotAnswered) {
  TestBoard board;
  EXPECT_FALSE(board.exchange(KZ_TYPE_state_reply, Bytes(KZ_SIZE_state_reply)));
  EXPECT_FALSE(board.exchange(KZ_TYPE_refused, Bytes(KZ_SIZE_refused)));
}

TEST(Requests, NeverMoreThanTheRoomOfTheTransmitter) {
  TestBoard board;
  board.input.tx_room = 3;
  board.send(KZ_TYPE_state, 1, {});
  for (int i = 0; i < 40; ++i) {
    board.tick();
    ASSERT_LE(board.output.tx_count, 3);
  }
  EXPECT_EQ(board.replies.size(), 1u);
}

}  // namespace
}  // namespace kaz::test
