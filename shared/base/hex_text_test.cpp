// Bytes as hexadecimal digits.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/hex_text.hpp"

#include <gtest/gtest.h>

#include <array>

namespace kaz {
namespace {

TEST(HexText, HasTwoDigitsAByte) {
  const std::array<std::uint8_t, 3> bytes{0x00, 0x4b, 0xff};
  EXPECT_EQ(hex_text(bytes), "004bff");
  EXPECT_EQ(hex_text(bytes, " "), "00 4b ff");
  EXPECT_EQ(hex_text({}, " "), "");
}

}  // namespace
}  // namespace kaz
