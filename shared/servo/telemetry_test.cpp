// Telemetry: when its frames come, their contents, when it ends.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "shared/servo/board_testing.h"

namespace kaz::test {
namespace {

constexpr u8 kEverything = 15;

u32 tick_of(const Reply& reply) {
  return static_cast<u32>(reply.fields[0] << 24 | reply.fields[1] << 16 | reply.fields[2] << 8 |
                          reply.fields[3]);
}

// Ticks with a host that is there; only telemetry is left in `replies`.
void run(TestBoard& board, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    if (i % 40 == 39) board.send(KZ_TYPE_heartbeat, ++board.sequence, {0, 0});
    board.tick();
  }
  std::erase_if(board.replies, [](const Reply& reply) { return reply.type < 0xC0; });
}

TEST(Telemetry, ComesEveryPeriodBeginningOnePeriodAfterTheRequest) {
  TestBoard board;
  ASSERT_EQ(board.telemetry(20, KZ_TELEMETRY_STATE), 0);
  const u32 start = board.input.tick;
  EXPECT_EQ(board.status() & KZ_STATUS_TELEMETRY, KZ_STATUS_TELEMETRY);
  board.replies.clear();
  run(board, 420);
  ASSERT_GE(board.replies.size(), 20u);
  for (std::size_t i = 0; i < board.replies.size(); ++i) {
    const Reply& reply = board.replies[i];
    EXPECT_EQ(reply.type, KZ_TYPE_telemetry_state);
    EXPECT_EQ(reply.address, KZ_ADDRESS_DEFAULT);
    EXPECT_EQ(reply.sequence, i);  // counts telemetry frames
    EXPECT_NEAR(tick_of(reply), start + 20 * (i + 1), 5) << i;
  }
  ASSERT_EQ(board.telemetry(0, KZ_TELEMETRY_STATE), 0);
  board.ticks(10);
  board.replies.clear();
  run(board, 200);
  EXPECT_TRUE(board.replies.empty());
  EXPECT_EQ(board.status(), 0);
}

TEST(Telemetry, ReportsAnglesCommandsDrivesAndHealth) {
  TestBoard board;
  board.set_pot(1, 600);
  board.input.busy_8states = 1000;
  board.input.worst_8states = 1100;
  ASSERT_EQ(board.enable(1), 0);
  ASSERT_EQ(board.target(0, 100, 0), 0);
  ASSERT_EQ(board.telemetry(50, kEverything), 0);
  board.replies.clear();
  run(board, 80);
  ASSERT_EQ(board.replies.size(), 4u);
  const auto state = fields_of<kz_telemetry_state, kz_unpack_telemetry_state>(board.replies[0]);
  EXPECT_EQ(board.replies[0].type, KZ_TYPE_telemetry_state);
  EXPECT_EQ(state.angle[1], kz_pot_angle(&kz_board_joints[1], 600));
  EXPECT_EQ(state.supply_mv, 10005);
  EXPECT_EQ(state.status, KZ_STATUS_ENABLED | KZ_STATUS_TELEMETRY);
  const auto commands =
      fields_of<kz_telemetry_commands, kz_unpack_telemetry_commands>(board.replies[1]);
  EXPECT_EQ(board.replies[1].type, KZ_TYPE_telemetry_commands);
  EXPECT_EQ(commands.angle[0], 100);
  EXPECT_EQ(commands.angle[1], state.angle[1]);
  const auto drives = fields_of<kz_telemetry_drives, kz_unpack_telemetry_drives>(board.replies[2]);
  EXPECT_EQ(board.replies[2].type, KZ_TYPE_telemetry_drives);
  // 0.0100 rad less the 0.0016 that code 512 stands for, at 16 /rad: 0.134 of 255.
  EXPECT_EQ(drives.duty[0], 34);
  EXPECT_EQ(drives.duty[1], 0);
  const auto health = fields_of<kz_telemetry_health, kz_unpack_telemetry_health>(board.replies[3]);
  EXPECT_EQ(board.replies[3].type, KZ_TYPE_telemetry_health);
  EXPECT_EQ(health.detail, 255);
  EXPECT_EQ(health.supply_mv, 10005);
  EXPECT_EQ(health.temperature_dc, 250);
  EXPECT_EQ(health.busy_8states, 1000);
  EXPECT_EQ(health.worst_8states, 1100);
}

TEST(Telemetry, RepliesComeFirst) {
  TestBoard board;
  ASSERT_EQ(board.telemetry(20, kEverything), 0);
  board.replies.clear();
  while (board.replies.empty()) board.tick();
  board.tick();  // the first of four is there, the second under way
  board.send(KZ_TYPE_identify, 77, {});
  board.send(KZ_TYPE_state, 78, {});
  board.ticks(30);
  ASSERT_GE(board.replies.size(), 4u);
  EXPECT_EQ(board.replies[1].type, KZ_TYPE_telemetry_commands);
  EXPECT_EQ(board.replies[2].type, KZ_TYPE_identify_reply);
  EXPECT_EQ(board.replies[3].type, KZ_TYPE_state_reply);
}

TEST(Telemetry, WhatTheWireHasNoTimeForIsDroppedAndCounted) {
  TestBoard board;
  ASSERT_EQ(board.telemetry(KZ_TELEMETRY_PERIOD_MIN_MS, kEverything), 0);
  board.replies.clear();
  run(board, 205);
  const std::size_t sent = board.replies.size();
  const kz_statistics_reply statistics = board.statistics();
  // 4 frames every 5 ms; 16 bytes a tick carry about 80 of 190.
  EXPECT_GT(statistics.telemetry_dropped, 60);
  EXPECT_NEAR(static_cast<double>(sent) + statistics.telemetry_dropped, 41 * 4, 12);
}

TEST(Telemetry, ATooShortPeriodOrAnUnknownSelectionIsRefused) {
  TestBoard board;
  for (u16 period = 1; period < KZ_TELEMETRY_PERIOD_MIN_MS; ++period) {
    EXPECT_EQ(board.telemetry(period, 1), KZ_REFUSED_RANGE);
    EXPECT_EQ(board.detail, 0);
  }
  EXPECT_EQ(board.telemetry(20, 16), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 1);
  EXPECT_EQ(board.status(), 0);
  EXPECT_EQ(board.telemetry(KZ_TELEMETRY_PERIOD_MIN_MS, 1), 0);
}

TEST(Telemetry, ASharedLineKnowsNone) {
  kz_startup startup = TestBoard::valid_startup();
  startup.shared_line = 1;
  TestBoard board(startup);
  EXPECT_EQ(board.telemetry(20, 1), KZ_REFUSED_SHARED_LINE);
  const auto identity = board.query<kz_identify_reply, kz_unpack_identify_reply>(KZ_TYPE_identify);
  EXPECT_EQ(identity.capabilities & KZ_CAPABILITY_TELEMETRY, 0);
  TestBoard alone;
  EXPECT_EQ(
      (alone.query<kz_identify_reply, kz_unpack_identify_reply>(KZ_TYPE_identify)).capabilities,
      15);
}

TEST(Telemetry, EndsWhenTheHostIsSilentAlsoWithMotorsOff) {
  TestBoard board;
  ASSERT_EQ(board.telemetry(10, KZ_TELEMETRY_HEALTH), 0);
  const u32 start = board.input.tick;
  board.replies.clear();
  board.ticks(300);
  ASSERT_GE(board.replies.size(), 8u);
  for (const Reply& reply : board.replies) EXPECT_LE(tick_of(reply), start + 91);
  EXPECT_EQ(board.status(), 0);  // motors are off: no fault
}

TEST(Telemetry, ANewRequestReplacesTheOld) {
  TestBoard board;
  ASSERT_EQ(board.telemetry(10, kEverything), 0);
  run(board, 30);
  ASSERT_EQ(board.telemetry(30, KZ_TELEMETRY_HEALTH), 0);
  board.ticks(8);
  board.replies.clear();
  run(board, 120);
  ASSERT_NEAR(static_cast<double>(board.replies.size()), 4, 1);
  for (const Reply& reply : board.replies) EXPECT_EQ(reply.type, KZ_TYPE_telemetry_health);
}

}  // namespace
}  // namespace kaz::test
