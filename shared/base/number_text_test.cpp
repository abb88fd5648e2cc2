// Numbers as text: the whole of it, finite, within the type.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/number_text.hpp"

#include <gtest/gtest.h>

namespace kaz {
namespace {

TEST(NumberText, IsReadAsAWhole) {
  EXPECT_EQ(parse_number<int>("-12"), -12);
  EXPECT_EQ(parse_number<double>("-0.95"), -0.95);
  EXPECT_EQ(parse_number<double>("1e-3"), 1e-3);
  for (const char* text : {"", " 1", "1 ", "1x", "+1", "x", "0x10", "1,5"}) {
    EXPECT_FALSE(parse_number<int>(text)) << text;
    EXPECT_FALSE(parse_number<double>(text)) << text;
  }
  EXPECT_FALSE(parse_number<int>("1.5"));
}

TEST(NumberText, IsFiniteAndWithinItsType) {
  for (const char* text : {"nan", "inf", "-inf", "1e999"})
    EXPECT_FALSE(parse_number<double>(text)) << text;
  EXPECT_FALSE(parse_number<int>("2147483648"));
  EXPECT_FALSE(parse_number<unsigned>("-1"));
}

}  // namespace
}  // namespace kaz
