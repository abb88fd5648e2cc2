// The codec made from the message table, and the table as data.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/messages.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "shared/protocol/message_info.h"

namespace {

TEST(Messages, NumbersAreBigEndianInTheOrderOfTheTable) {
  const kz_gains gains = {
      .mask = 0x01020304, .kp = 0x0506, .kd = 0x0708, .dead_band = 0x090A, .friction = 0x0B};
  u8 fields[KZ_PAYLOAD_MAX];
  const u8 length = kz_pack_gains(&gains, fields);
  EXPECT_EQ(std::vector<u8>(fields, fields + length),
            (std::vector<u8>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
}

TEST(Messages, MaskedNumbersStandOnlyForTheirBits) {
  kz_targets targets = {};
  targets.mask = 1u << 1 | 1u << 17;
  targets.duration_ms = 500;
  targets.angle[1] = -2;
  targets.angle[17] = 0x1234;
  targets.angle[5] = 99;  // not in the mask
  u8 fields[KZ_PAYLOAD_MAX];
  const u8 length = kz_pack_targets(&targets, fields);
  EXPECT_EQ(std::vector<u8>(fields, fields + length),
            (std::vector<u8>{0, 2, 0, 2, 0x01, 0xF4, 0xFF, 0xFE, 0x12, 0x34}));

  kz_targets back;
  ASSERT_EQ(kz_unpack_targets(&back, fields, length), 1);
  EXPECT_EQ(back.mask, targets.mask);
  EXPECT_EQ(back.duration_ms, 500);
  EXPECT_EQ(back.angle[1], -2);
  EXPECT_EQ(back.angle[17], 0x1234);
  EXPECT_EQ(back.angle[5], 0);
}

TEST(Messages, EveryWrongLengthIsRefused) {
  kz_targets targets = {};
  targets.mask = 0x3FFFF;
  u8 fields[KZ_PAYLOAD_MAX + 1] = {};
  const u8 right = kz_pack_targets(&targets, fields);
  ASSERT_EQ(right, KZ_SIZE_targets);
  for (u8 length = 0; length <= KZ_PAYLOAD_MAX; ++length) {
    kz_targets back;
    EXPECT_EQ(kz_unpack_targets(&back, fields, length), length == right) << int{length};
  }
  kz_identify none;
  EXPECT_EQ(kz_unpack_identify(&none, fields, 0), 1);
  EXPECT_EQ(kz_unpack_identify(&none, fields, 1), 0);
}

TEST(Messages, RoundTripOfTheLargestReply) {
  kz_state_reply state = {};
  state.tick = 0xDEADBEEF;
  state.status = 0x8001;
  state.supply_mv = 65535;
  for (int i = 0; i < KZ_JOINTS; ++i)
    state.angle[i] = static_cast<s16>(i % 2 ? -32768 + i : 32767 - i);
  u8 fields[KZ_PAYLOAD_MAX];
  const u8 length = kz_pack_state_reply(&state, fields);
  EXPECT_EQ(length, 4 + 2 + 2 + 18 * 2);
  kz_state_reply back;
  ASSERT_EQ(kz_unpack_state_reply(&back, fields, length), 1);
  EXPECT_EQ(back.tick, state.tick);
  EXPECT_EQ(back.status, state.status);
  EXPECT_EQ(back.supply_mv, state.supply_mv);
  for (int i = 0; i < KZ_JOINTS; ++i) EXPECT_EQ(back.angle[i], state.angle[i]);
}

TEST(MessageInfo, CodesAndNamesAreUniqueAndSizesAddUp) {
  std::set<int> codes;
  std::set<std::string> names;
  for (int i = 0; i < kz_message_count; ++i) {
    const kz_message_info& info = kz_messages[i];
    EXPECT_TRUE(codes.insert(info.code).second) << info.name;
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    int size = 0;
    for (int f = 0; f < info.field_count; ++f) size += info.fields[f].size * info.fields[f].count;
    EXPECT_EQ(size, info.size_max) << info.name;
    EXPECT_LE(size, KZ_PAYLOAD_MAX) << info.name;
    EXPECT_EQ(kz_message_find(info.code), &info);
  }
  EXPECT_EQ(kz_message_find(0x7E), nullptr);
}

const kz_field_info& field_of(const char* message, const std::string& field) {
  for (int i = 0; i < kz_message_count; ++i) {
    if (std::string(kz_messages[i].name) != message) continue;
    for (int f = 0; f < kz_messages[i].field_count; ++f)
      if (kz_messages[i].fields[f].name == field) return kz_messages[i].fields[f];
  }
  ADD_FAILURE() << message << " has no field " << field;
  return kz_messages[0].fields[0];
}

TEST(MessageInfo, ReportsTheBounds) {
  EXPECT_EQ(field_of("raw_drive", "duty").low, -255);
  EXPECT_EQ(field_of("raw_drive", "duty").high, 255);
  EXPECT_EQ(field_of("raw_drive", "duty").bounded, 1);
  EXPECT_EQ(field_of("enable", "mask").high, KZ_ALL_JOINTS);
  EXPECT_EQ(field_of("unlock", "key").low, KZ_KEY);
  EXPECT_EQ(field_of("identify_reply", "tick").high, 0xFFFFFFFFLL);
  EXPECT_EQ(field_of("targets", "angle").low, -32768);
  EXPECT_EQ(field_of("targets", "angle").bounded, 0);
}

TEST(MessageInfo, EachRequestHasItsReply) {
  for (int i = 0; i < kz_message_count; ++i) {
    const kz_message_info& info = kz_messages[i];
    if (info.code & KZ_REPLY) continue;
    // Else its reply would be taken for telemetry.
    EXPECT_TRUE(info.code > 0 && info.code < 0x40) << info.name;
    const kz_message_info* reply = kz_message_find(static_cast<u8>(info.code | KZ_REPLY));
    ASSERT_NE(reply, nullptr) << info.name;
    EXPECT_EQ(std::string(reply->name), std::string(info.name) + "_reply");
    EXPECT_EQ(std::string(reply->fields[0].name), "tick");  // so the host can place it in time
  }
}

}  // namespace
