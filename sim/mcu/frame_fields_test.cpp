// Frames that differ are described by message and field.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/frame_fields.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shared/protocol/message_info.h"
#include "shared/protocol/messages.h"

namespace kaz::sim {
namespace {

using Body = std::vector<std::uint8_t>;

template <class Fields>
Body body_of(std::uint8_t type, const Fields& fields, u8 (*pack)(const Fields*, u8*)) {
  Body body(KZ_BODY_MAX);
  body[KZ_BODY_ADDRESS] = 1;
  body[KZ_BODY_TYPE] = type;
  body[KZ_BODY_SEQUENCE] = 7;
  body.resize(std::size_t{KZ_HEADER_SIZE} + pack(&fields, &body[KZ_HEADER_SIZE]));
  return body;
}

Body identify_reply(std::uint32_t build_id, std::uint16_t status) {
  kz_identify_reply reply{};
  reply.build_id = build_id;
  reply.status = status;
  return body_of(KZ_TYPE_identify_reply, reply, kz_pack_identify_reply);
}

Body joint_reply(std::uint32_t mask, std::int16_t angle_of_4) {
  kz_joints_reply reply{};
  reply.mask = mask;
  reply.angle[4] = angle_of_4;
  return body_of(KZ_TYPE_joints_reply, reply, kz_pack_joints_reply);
}

TEST(FrameFields, AreNamedByMessageAndField) {
  const auto found = frame_differences(identify_reply(0x01020304, 5), identify_reply(2, 5));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].field, "identify_reply.build_id");
  EXPECT_EQ(found[0].native, 0x01020304);
  EXPECT_EQ(found[0].h8, 2);
  EXPECT_EQ(frame_differences(identify_reply(1, 1), identify_reply(2, 2)).size(), 2u);
  EXPECT_TRUE(frame_differences(identify_reply(1, 1), identify_reply(1, 1)).empty());
}

TEST(FrameFields, ElementsOfAMaskAreNamedByJoint) {
  const auto found = frame_differences(joint_reply(0x12, -30), joint_reply(0x12, 30));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].field, "joints_reply.angle[4]");
  EXPECT_EQ(found[0].native, -30);
  EXPECT_EQ(found[0].h8, 30);
  // What only one of them has is not compared with something else.
  const auto other = frame_differences(joint_reply(0x12, 30), joint_reply(0x10, 30));
  ASSERT_EQ(other.size(), 1u);
  EXPECT_EQ(other[0].field, "joints_reply.mask");
}

TEST(FrameFields, EqualFramesOfEveryMessageHaveNoDifference) {
  for (int m = 0; m < kz_message_count; ++m) {
    Body body(std::size_t{KZ_HEADER_SIZE} + kz_messages[m].size_max);
    for (std::size_t i = 0; i < body.size(); ++i) body[i] = static_cast<std::uint8_t>(17 * i + 1);
    body[KZ_BODY_TYPE] = kz_messages[m].code;
    EXPECT_TRUE(frame_differences(body, body).empty()) << kz_messages[m].name;
  }
}

TEST(FrameFields, OtherMessagesDifferInTheirType) {
  const auto found = frame_differences(identify_reply(1, 1), joint_reply(1, 1));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].field, "type (identify_reply, joints_reply)");
  const Body unknown{1, 0x7F, 0};
  EXPECT_TRUE(frame_differences(unknown, identify_reply(1, 1)).empty());
  EXPECT_TRUE(frame_differences(Body{1}, identify_reply(1, 1)).empty());
}

TEST(FrameFields, AreThoseOfTheSendersStuffedBody) {
  const Body body = identify_reply(0x00AB00CD, 0);
  kz_sender sender;
  kz_sender_init(&sender);
  EXPECT_TRUE(sent_body(sender).empty());
  std::ranges::copy(body, sender.body);
  kz_sender_start(&sender, static_cast<u8>(body.size()));
  EXPECT_EQ(sent_body(sender), body);
  sender.body[sender.first - 1] = 0;  // a stuffed body has no zero
  EXPECT_TRUE(sent_body(sender).empty());
}

}  // namespace
}  // namespace kaz::sim
