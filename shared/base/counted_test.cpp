// Nouns agree with their numbers.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/counted.hpp"

#include <cstddef>

#include <gtest/gtest.h>

namespace kaz {
namespace {

TEST(Counted, OneHasNoS) {
  EXPECT_EQ(counted(0, "case"), "0 cases");
  EXPECT_EQ(counted(1, "case"), "1 case");
  EXPECT_EQ(counted(std::size_t{2}, "case"), "2 cases");
  EXPECT_EQ(counted(-1LL, "block"), "-1 blocks");
}

}  // namespace
}  // namespace kaz
