// The shared wire: rates, collisions, damage.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/half_duplex_line.h"

#include <gtest/gtest.h>

namespace kaz::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::microseconds;
using std::chrono::milliseconds;

struct Heard {
  Bytes bytes;
  std::vector<Time> at;
  int without_stop_bit = 0;
};

Heard listen(HalfDuplexLine& line, std::size_t node, Time until) {
  Heard heard;
  while (const auto received = line.next(until)) {
    if (received->node != node) continue;
    if (!received->stop_bit) {
      ++heard.without_stop_bit;
      continue;
    }
    heard.bytes.push_back(received->byte);
    heard.at.push_back(received->at);
  }
  return heard;
}

Bytes every_byte() {
  Bytes bytes(256);
  for (std::size_t i = 0; i < 256; ++i) bytes[i] = static_cast<std::uint8_t>(i);
  return bytes;
}

TEST(HalfDuplexLine, CarriesEveryByteInTenBitTimes) {
  for (const double baud : {1e6, 500e3, 115200.0, 76800.0, 38400.0}) {
    HalfDuplexLine line(3, baud);
    const Time end = line.send(0, every_byte(), microseconds(7));
    EXPECT_NEAR(seconds(end - microseconds(7)), 2560 / baud, 1e-9);
    const Heard heard = listen(line, 2, end + microseconds(1));
    EXPECT_EQ(heard.bytes, every_byte()) << baud;
    EXPECT_EQ(heard.without_stop_bit, 0);
    EXPECT_NEAR(seconds(heard.at[9] - microseconds(7)), 100 / baud, 1e-9);
  }
}

TEST(HalfDuplexLine, SenderDoesNotHearItself) {
  HalfDuplexLine line(2);
  const Time end = line.send(0, every_byte(), Time(0));
  EXPECT_TRUE(listen(line, 0, end + milliseconds(1)).bytes.empty());
}

// UARTs sample ten bits: half a bit at the end is 5 %, a little less is left by what else differs.
TEST(HalfDuplexLine, ToleratesThreePercentOfRateAndNoTen) {
  for (const double error : {-0.03, 0.03}) {
    HalfDuplexLine line(2);
    line.set_baud(1, 1e6 * (1 + error));
    const Time end = line.send(0, every_byte(), Time(0));
    EXPECT_EQ(listen(line, 1, end + milliseconds(1)).bytes, every_byte()) << error;
  }
  for (const double error : {-0.1, 0.1}) {
    HalfDuplexLine line(2);
    line.set_baud(1, 1e6 * (1 + error));
    const Time end = line.send(0, every_byte(), Time(0));
    EXPECT_NE(listen(line, 1, end + milliseconds(1)).bytes, every_byte()) << error;
  }
}

// A start bit at 115,200 baud is some nine bits long at 1 Mbaud: a byte of zeros, and what comes after.
TEST(HalfDuplexLine, AnotherRateIsGarbage) {
  HalfDuplexLine line(2);
  line.set_baud(0, 115200);
  const Time end = line.send(0, Bytes{0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB}, Time(0));
  const Heard heard = listen(line, 1, end + milliseconds(1));
  EXPECT_GT(heard.bytes.size() + static_cast<std::size_t>(heard.without_stop_bit), 6u);
  EXPECT_NE(heard.bytes, (Bytes{0xFF, 0xFF, 0x01, 0x02, 0x01, 0xFB}));
}

TEST(HalfDuplexLine, LowWinsWhereTwoSendAtOnce) {
  HalfDuplexLine line(3);
  line.send(1, Bytes{0xF5, 0x12, 0x77}, microseconds(50));
  const Time end = line.send(2, Bytes{0x3F, 0x12, 0x0F}, microseconds(50));
  EXPECT_EQ(listen(line, 0, end).bytes, (Bytes{0x35, 0x12, 0x07}));
}

TEST(HalfDuplexLine, ShiftedBytesDamageEachOther) {
  HalfDuplexLine line(3);
  line.send(1, Bytes{0xAA, 0xAA, 0xAA}, Time(0));
  const Time end = line.send(2, Bytes{0xAA, 0xAA, 0xAA}, microseconds(3));
  const Heard heard = listen(line, 0, end + milliseconds(1));
  EXPECT_NE(heard.bytes, (Bytes{0xAA, 0xAA, 0xAA}));
}

TEST(HalfDuplexLine, BytesOfOneSenderFollowEachOther) {
  HalfDuplexLine line(2);
  const Time first = line.send(0, Bytes{1}, Time(0));
  EXPECT_EQ(line.send(0, Bytes{2}, Time(0)), first + microseconds(10));
  EXPECT_EQ(line.send(0, Bytes{3}, milliseconds(1)), milliseconds(1) + microseconds(10));
  EXPECT_EQ(listen(line, 1, milliseconds(2)).bytes, (Bytes{1, 2, 3}));
}

// An answer is on the wire as soon as the request's last byte has come.
TEST(HalfDuplexLine, AnswersWithoutAPause) {
  HalfDuplexLine line(2);
  line.send(0, Bytes{7}, Time(0));
  const auto request = line.next(milliseconds(1));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->at, microseconds(10));
  line.send(1, Bytes{8}, request->at);
  const auto answer = line.next(milliseconds(1));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->node, 0u);
  EXPECT_EQ(answer->byte, 8);
  EXPECT_EQ(answer->at, microseconds(20));
}

// The sender is 2 % slow, so that its stop bit is not over when the answer begins.
TEST(HalfDuplexLine, HearsAnAnswerInItsOwnStopBit) {
  HalfDuplexLine line(2);
  line.set_baud(0, 0.98e6);
  line.send(0, Bytes{7}, Time(0));
  const auto request = line.next(milliseconds(1));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->at, microseconds(10));
  line.send(1, Bytes{0xFF, 8}, request->at);
  const auto first = line.next(milliseconds(1)), second = line.next(milliseconds(1));
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->byte, 0xFF);
  EXPECT_EQ(second->byte, 8);
}

TEST(HalfDuplexLine, ReturnsTheBytesOfANodeWithAnEcho) {
  HalfDuplexLine line(2);
  line.set_echo(0, true);
  line.send(0, Bytes{7, 8}, Time(0));
  for (const auto& [node, byte] : {std::pair{0, 7}, {1, 7}, {0, 8}, {1, 8}}) {
    const auto received = line.next(milliseconds(1));
    ASSERT_TRUE(received);
    EXPECT_EQ(received->node, static_cast<std::size_t>(node));
    EXPECT_EQ(received->byte, byte);
    EXPECT_TRUE(received->stop_bit);
    if (node == 1 && byte == 8) line.send(1, Bytes{9}, received->at);
  }
  const auto answer = line.next(milliseconds(1));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->node, 0u);
  EXPECT_EQ(answer->byte, 9);
  EXPECT_FALSE(line.next(milliseconds(1))) << "node 1 has no echo";
}

TEST(HalfDuplexLine, DamagesTheShareThatIsSet) {
  HalfDuplexLine line(2);
  line.set_damage(0.01, 3);
  int wrong = 0;
  Time at{};
  for (int i = 0; i < 20000; ++i) {
    at = line.send(0, Bytes{0x5A}, at);
    const auto received = line.next(at);
    ASSERT_TRUE(received);
    wrong += received->byte != 0x5A ? 1 : 0;
  }
  EXPECT_EQ(static_cast<std::uint64_t>(wrong), line.damaged());
  EXPECT_NEAR(wrong, 200, 45);  // three sigma of 20,000 draws
}

}  // namespace
}  // namespace kaz::sim
