// The list of the state's fields: complete, without overlap, and laid out as on the H8.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/fields.h"

#include <gtest/gtest.h>

#include <vector>

namespace {

TEST(StateFields, CoverEveryByteOnceAndNoneIsPadding) {
  std::vector<int> covered(sizeof(kz_servo), 0);
  for (int f = 0; f < kz_state_field_count; ++f) {
    const kz_state_field& field = kz_state_fields[f];
    for (int i = 0; i < field.count; ++i)
      for (int byte = 0; byte < field.size; ++byte)
        ++covered[static_cast<std::size_t>(field.offset + i * field.stride + byte)];
  }
  // Only behind the last field may the compilers round up, each to its own alignment.
  const std::size_t end = offsetof(kz_servo, sender.body) + KZ_BODY_MAX;
  for (std::size_t byte = 0; byte < covered.size(); ++byte) {
    EXPECT_EQ(covered[byte], byte < end ? 1 : 0) << "byte " << byte;
  }
  EXPECT_GE(kz_state_size_h8, end);
  EXPECT_LE(kz_state_size_h8, sizeof(kz_servo));
}

TEST(StateFields, AreAlignedForBothMachines) {
  for (int f = 0; f < kz_state_field_count; ++f) {
    const kz_state_field& field = kz_state_fields[f];
    EXPECT_EQ(field.offset % field.size, 0) << field.name;
    EXPECT_EQ(field.stride % field.size, 0) << field.name;
  }
}

TEST(TickInput, HasNoPaddingBeforeItsEnd) {
  EXPECT_EQ(offsetof(kz_tick_input, rx_flags), 4u + 4 * 2 + 2 * KZ_ANALOG + 5 + KZ_RX_PER_TICK);
  EXPECT_EQ(offsetof(kz_tick_output, tx), 16u + 2 + 4 + 2);
}

}  // namespace
