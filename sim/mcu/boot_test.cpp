// An erased board hangs until reset, and its boot mode replies at the host's bit rate.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/mcu/h8_mcu.h"

namespace kaz::sim {
namespace {

constexpr States kBit = KZ_CLOCK_HZ / 9600;

TEST(ErasedChip, StopsUnlessItMayHang) {
  const auto strict = make_erased_h8();
  EXPECT_FALSE(strict->run_until(10 * KZ_STATES_PER_TICK));
  const auto mcu = make_erased_h8();
  std::string why;
  mcu->on_hang([&why](const std::string& report) { why = report; });
  ASSERT_TRUE(mcu->run_until(10 * KZ_STATES_PER_TICK));
  EXPECT_NE(why.find("fetch"), std::string::npos) << why;
  EXPECT_EQ(mcu->now(), 10 * KZ_STATES_PER_TICK);
  ASSERT_TRUE(mcu->run_until(20 * KZ_STATES_PER_TICK));
  EXPECT_EQ(mcu->now(), 20 * KZ_STATES_PER_TICK);
}

TEST(ErasedChip, AnswersInBootMode) {
  const auto mcu = make_erased_h8();
  mcu->on_hang([](const std::string&) {});
  ASSERT_TRUE(mcu->run_until(5 * KZ_STATES_PER_TICK));
  ASSERT_TRUE(mcu->set_boot_pins(true));
  mcu->reset();
  EXPECT_TRUE(mcu->in_boot_rom());
  for (int k = 1; k <= 4; ++k) mcu->receive({0, mcu->now() + 10 * k * kBit, false, kBit});
  ASSERT_TRUE(mcu->run_until(mcu->now() + 100 * kBit));
  const auto answer = mcu->take_transmitted();
  ASSERT_EQ(answer.size(), 1u);
  EXPECT_EQ(answer[0].value, 0);
  EXPECT_EQ(answer[0].bit_states, kBit);
}

TEST(ErasedChip, NativeHasNoBootMode) {
  EXPECT_FALSE(make_native()->set_boot_pins(true));
  EXPECT_TRUE(make_native()->set_boot_pins(false));
}

}  // namespace
}  // namespace kaz::sim
