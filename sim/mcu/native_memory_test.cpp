// The native engine's flash: stores, wear, and power loss at any time during a store.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/native_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "shared/base/random.hpp"
#include "shared/protocol/messages.h"

namespace kaz::sim {
namespace {

using Values = std::array<s16, 2 * KZ_JOINTS>;

kz_servo servo_with(int n) {
  kz_servo servo{};
  for (int j = 0; j < KZ_JOINTS; ++j) {
    servo.joint[j].pot_centre = static_cast<s16>(31 * n - 77 * j);
    servo.joint[j].pot_scale = static_cast<s16>(16000 + 7 * n - j);
  }
  return servo;
}

Values values_of(int n) {
  Values values{};
  const kz_servo servo = servo_with(n);
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    values[2 * j] = servo.joint[j].pot_centre;
    values[2 * j + 1] = servo.joint[j].pot_scale;
  }
  return values;
}

Values found_in(NativeMemory memory) {
  kz_startup startup{};
  memory.load(startup);
  Values values{};
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    values[2 * j] = startup.pot_centre[j];
    values[2 * j + 1] = startup.pot_scale[j];
  }
  return values;
}

NativeMemory with_copies(int copies) {
  NativeMemory memory;
  kz_startup startup{};
  memory.load(startup);
  for (int i = 1; i <= copies; ++i) {
    memory.store_calibration(servo_with(i), 0);
    EXPECT_TRUE(memory.finish());
  }
  return memory;
}

TEST(NativeMemory, StoresReadsBackAndCountsWear) {
  NativeMemory memory = with_copies(35);
  EXPECT_EQ(found_in(memory), values_of(35));
  kz_tick_input input{};
  memory.report(input);
  EXPECT_EQ(input.calibration_sequence, 35);
  EXPECT_EQ(input.erases_a, 1);
  EXPECT_EQ(input.erases_b, 2);
}

TEST(NativeMemory, AddressStandsBesideTheCalibration) {
  NativeMemory memory = with_copies(3);
  kz_servo servo{};
  servo.new_address = 9;
  servo.new_shared_line = 1;
  memory.store_address(servo, 0);
  ASSERT_TRUE(memory.finish());
  kz_startup startup{};
  memory.load(startup);
  EXPECT_EQ(startup.address, 9);
  EXPECT_EQ(startup.shared_line, 1);
  EXPECT_EQ(found_in(memory), values_of(3));
}

TEST(NativeMemory, BytesAreTheWholeOfIt) {
  const NativeMemory memory = with_copies(12);
  NativeMemory other;
  other.set_bytes(memory.bytes());
  EXPECT_EQ(found_in(other), values_of(12));
}

TEST(NativeMemory, SpoiltWhileItIsWrittenIsNoticed) {
  NativeMemory memory = with_copies(1);
  memory.store_calibration(servo_with(2), 0);
  std::array<std::uint8_t, Mcu::kMemorySize> spoilt{};
  std::copy(memory.bytes().begin(), memory.bytes().end(), spoilt.begin());
  spoilt[4 * KZ_STORE_LINE + 1] = 0;  // of the second line of the copy
  memory.set_bytes(spoilt);
  EXPECT_FALSE(memory.finish());
  EXPECT_EQ(found_in(memory), values_of(1));
}

// At every 16th state of a store: during pulses and between them.
TEST(NativeMemory, PowerLostAnywhereLeavesTheOldOrTheNewCopy) {
  constexpr States step = 16;
  for (const int copies : {0, 4, 10, 20}) {
    NativeMemory before = with_copies(copies);
    const Values old = found_in(before), newer = values_of(99);
    before.store_calibration(servo_with(99), 1000);
    int olds = 0, news = 0, torn = 0;
    for (States at = 0; at <= before.over_at() + step; at += step) {
      NativeMemory cut = before;
      cut.cut(at);
      const Values left = found_in(cut);
      ASSERT_TRUE(left == old || left == newer) << copies << " copies, cut at " << at;
      ++(left == newer ? news : olds);
      torn += left == old &&
              !std::equal(cut.bytes().begin(), cut.bytes().end(), before.bytes().begin());
      // The next store starts from that state.
      if (at % (64 * step) == 0) {
        kz_startup startup{};
        cut.load(startup);
        cut.store_calibration(servo_with(100), 0);
        ASSERT_TRUE(cut.finish());
        ASSERT_EQ(found_in(cut), values_of(100));
      }
    }
    EXPECT_GT(olds, 500);
    EXPECT_GT(news, 1);
    EXPECT_GT(torn, 100);
    std::printf(
        "native: power cut at %d states of a store behind %d copies: %d old (%d torn), %d new\n",
        olds + news, copies, olds, torn, news);
  }
}

TEST(NativeMemory, PowerLostAgainAndAgainNeverCostsTheLastCopy) {
  Random random(3);
  NativeMemory memory = with_copies(1);
  Values kept = values_of(1);
  for (int i = 2; i < 2000; ++i) {
    kz_startup startup{};
    memory.load(startup);
    memory.store_calibration(servo_with(i % 500), 0);
    memory.cut(random.below(static_cast<std::uint32_t>(memory.over_at() * 5 / 4)));
    const Values left = found_in(memory);
    ASSERT_TRUE(left == kept || left == values_of(i % 500)) << i;
    kept = left;
  }
}

}  // namespace
}  // namespace kaz::sim
