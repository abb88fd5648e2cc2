// Decoding of the tick's structures from the H8's memory, and the random numbers.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>

#include "shared/base/random.hpp"
#include "sim/mcu/h8_layout.h"

namespace kaz::sim {
namespace {

TEST(H8Layout, InputIsBigEndianInTheOrderOfItsFields) {
  std::array<std::uint8_t, h8_layout::kInputSize> bytes{};
  EXPECT_EQ(bytes.size(), 98u);  // 4 + 8 + 48 + 5 + 32 + 1
  const std::array<std::uint8_t, 14> head{0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07,
                                          0x08, 0x09, 0x0a, 0x0b, 0x0c, 0x03, 0xff};
  std::copy(head.begin(), head.end(), bytes.begin());
  bytes[12 + 2 * 23 + 1] = 0x42;  // analog[23], low byte
  bytes[60] = 2;                  // erases_a
  bytes[61] = 3;                  // erases_b
  bytes[62] = 1;                  // result
  bytes[63] = 100;                // tx_room
  bytes[64] = 16;                 // rx_count
  bytes[65 + 15] = 0xaa;
  bytes[81 + 15] = 0x10;
  const kz_tick_input input = h8_layout::decode_input(bytes);
  EXPECT_EQ(input.tick, 0x01020304u);
  EXPECT_EQ(input.busy_8states, 0x0506);
  EXPECT_EQ(input.worst_8states, 0x0708);
  EXPECT_EQ(input.missed, 0x090a);
  EXPECT_EQ(input.calibration_sequence, 0x0b0c);
  EXPECT_EQ(input.analog[0], 0x03ff);
  EXPECT_EQ(input.analog[23], 0x42);
  EXPECT_EQ(input.erases_a, 2);
  EXPECT_EQ(input.erases_b, 3);
  EXPECT_EQ(input.result, 1);
  EXPECT_EQ(input.tx_room, 100);
  EXPECT_EQ(input.rx_count, 16);
  EXPECT_EQ(input.rx[15], 0xaa);
  EXPECT_EQ(input.rx_flags[15], 0x10);
}

TEST(H8Layout, OutputIsBytes) {
  std::array<std::uint8_t, h8_layout::kOutputSize> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  const kz_tick_output output = h8_layout::decode_output(bytes);
  EXPECT_EQ(output.pw[15], 15);
  EXPECT_EQ(output.tmo[1], 17);
  EXPECT_EQ(output.p3, 18);
  EXPECT_EQ(output.p6, 21);
  EXPECT_EQ(output.action, 22);
  EXPECT_EQ(output.tx_count, 23);
  EXPECT_EQ(output.tx[15], 39);
}

// First outputs of SplitMix64 with seed 1234567, as its authors' reference code gives them.
TEST(Random, IsSplitMix64) {
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317u);
  EXPECT_EQ(random.next(), 3203168211198807973u);
  EXPECT_EQ(random.next(), 9817491932198370423u);
}

TEST(Random, KeyedNormalHasMeanZeroAndSigmaOne) {
  double sum = 0, squares = 0;
  constexpr int count = 100000;
  for (int i = 0; i < count; ++i) {
    const double x = keyed_normal(1, static_cast<std::uint64_t>(i / 24), i % 24);
    sum += x;
    squares += x * x;
  }
  // Standard errors are 0.003 and 0.0045: five of them.
  EXPECT_NEAR(sum / count, 0.0, 0.016);
  EXPECT_NEAR(squares / count, 1.0, 0.023);
  EXPECT_NE(keyed_normal(1, 5, 3), keyed_normal(2, 5, 3));
  EXPECT_NE(keyed_normal(1, 5, 3), keyed_normal(1, 6, 3));
  EXPECT_NE(keyed_normal(1, 5, 3), keyed_normal(1, 5, 4));
}

}  // namespace
}  // namespace kaz::sim
