// The decoder of TxD0, on synthetic waveforms.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/uart_decoder.h"

#include <gtest/gtest.h>

namespace kaz::sim {
namespace {

// Feeds the frame's bits, each `bit` long, from `at` on. Returns the end.
States put(UartDecoder& line, std::uint8_t value, States at, States bit, bool stop = true) {
  const unsigned frame = static_cast<unsigned>(value) << 1 | (stop ? 0x200u : 0u);
  for (int k = 0; k < 10; ++k) line.level((frame >> k & 1) != 0, at + k * bit);
  return at + 10 * bit;
}

TEST(UartDecoder, EveryByteBackToBack) {
  UartDecoder line;
  States at = 1000;
  for (int value = 0; value < 256; ++value)
    at = put(line, static_cast<std::uint8_t>(value), at, 160);
  line.advance(at);
  const auto bytes = line.take();
  ASSERT_EQ(bytes.size(), 256u);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    EXPECT_EQ(bytes[i].value, i);
    EXPECT_EQ(bytes[i].start, 1000 + static_cast<States>(i) * 1600);
    EXPECT_FALSE(bytes[i].framing_error);
    EXPECT_EQ(bytes[i].edge_deviation, 0);
  }
  EXPECT_TRUE(line.take().empty());
}

TEST(UartDecoder, ByteIsThereWhenItsStopBitIsSampled) {
  UartDecoder line;
  put(line, 0x0F, 500, 160);
  line.advance(500 + 1519);
  EXPECT_TRUE(line.take().empty());
  line.advance(500 + 1520);
  EXPECT_EQ(line.take().size(), 1u);
}

// BRR 4 is 160 states a bit, 5 would be 192, 3 would be 128.
TEST(UartDecoder, WrongRatesShow) {
  for (const States bit : {States{128}, States{192}}) {
    UartDecoder line;
    const States end = put(line, 0x55, 1000, bit);
    line.advance(end + 2000);
    const auto bytes = line.take();
    ASSERT_FALSE(bytes.empty());
    EXPECT_TRUE(bytes[0].framing_error || bytes[0].value != 0x55);
    EXPECT_GT(bytes[0].edge_deviation, 20);
  }
}

TEST(UartDecoder, ShortFrameShowsInTheNextStartBit) {
  UartDecoder line;
  put(line, 0x00, 1000, 160);
  const States end = put(line, 0x00, 1000 + 1560, 160);
  line.advance(end);
  const auto bytes = line.take();
  ASSERT_EQ(bytes.size(), 2u);
  EXPECT_EQ(bytes[0].edge_deviation, 0);
  EXPECT_EQ(bytes[1].edge_deviation, 40);
}

TEST(UartDecoder, LowStopBitIsAFramingErrorAndASpikeIsNoByte) {
  UartDecoder line;
  States at = put(line, 0xA5, 1000, 160, false);
  line.level(true, at);
  line.level(false, at + 5000);
  line.level(true, at + 5040);
  line.advance(at + 20000);
  const auto bytes = line.take();
  ASSERT_EQ(bytes.size(), 1u);
  EXPECT_EQ(bytes[0].value, 0xA5);
  EXPECT_TRUE(bytes[0].framing_error);
}

TEST(UartDecoder, RestartGivesUpTheByteUnderWay) {
  UartDecoder line;
  line.level(false, 1000);
  line.restart(true);
  line.advance(10000);
  EXPECT_TRUE(line.take().empty());
}

}  // namespace
}  // namespace kaz::sim
