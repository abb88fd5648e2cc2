// The last frames as text: times, direction, fields, hexadecimal.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/frame_log.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "shared/protocol/message_info.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

TEST(FrameLog, FieldsAreThoseOfTheTable) {
  EXPECT_EQ(describe_fields(Bytes{1, KZ_TYPE_state, 5}), "");
  EXPECT_EQ(
      describe_fields(Bytes{1, KZ_TYPE_targets, 7, 0, 0, 0, 3, 0x01, 0xf4, 0x03, 0xe8, 0xff, 0xfe}),
      "mask=0x3 duration_ms=500 angle=[0:1000 1:-2]");
  EXPECT_EQ(describe_fields(Bytes{1, KZ_TYPE_refused, 7, 0, 0, 0, 9, 1, 0x01, KZ_TYPE_targets,
                                  KZ_REFUSED_FAULT, KZ_SHUTDOWN_STOP}),
            std::string("tick=9 status=ENABLED+'emergency stop' request=targets reason='") +
                kz_refusal_text(KZ_REFUSED_FAULT) + "' detail=1");
  EXPECT_EQ(describe_fields(Bytes{1, KZ_TYPE_enable, 7, 0, 0}), "fields do not fit the message");
  EXPECT_EQ(describe_fields(Bytes{1, KZ_TYPE_state, 7, 0}), "fields do not fit the message");
  EXPECT_EQ(describe_fields(Bytes{1, 0x70, 7}), "fields do not fit the message");
}

TEST(FrameLog, EveryMessageOfItsLongestFormIsRead) {
  for (int code = 0; code < 256; ++code) {
    if (std::string(message_name(static_cast<std::uint8_t>(code))) == "unknown") continue;
    Bytes body{1, static_cast<std::uint8_t>(code), 0};
    // Masks of all ones, wherever a mask can be, stand for the longest replies.
    for (int length = 0; length <= KZ_PAYLOAD_MAX; ++length) {
      body.resize(static_cast<std::size_t>(KZ_HEADER_SIZE + length), 0xff);
      (void)describe_fields(body);  // reads nothing beyond the body: the sanitizers look
    }
  }
}

TEST(FrameLog, KeepsTheLast64OldestFirst) {
  FrameLog log;
  for (int i = 0; i < 100; ++i) {
    log.add(i * 1ms, FrameLog::Direction::out,
            Bytes{1, KZ_TYPE_state, static_cast<std::uint8_t>(i)});
  }
  log.add(1234567us, FrameLog::Direction::damaged, Bytes{0xde, 0xad});
  const std::string text = log.text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 64);
  EXPECT_EQ(text.find("     0.037000  out  state            #37     | 01 05 25\n"), 0u) << text;
  EXPECT_NE(text.find("     1.234567  bad  damaged          #0    | de ad\n"), std::string::npos)
      << text;
}

}  // namespace
}  // namespace kaz::host
