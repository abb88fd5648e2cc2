// KAZ_TRY: values, errors, and how often what is evaluated.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/result.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace kaz {
namespace {

Result<int> half(int number) {
  if (number % 2 != 0) return fail(Fault::usage, std::to_string(number) + " is odd");
  return number / 2;
}

Result<void> expect_even(int number) {
  KAZ_TRY(half(number));
  return {};
}

Result<std::string> quarter_text(int number) {
  const int first = KAZ_TRY(half(number));
  const auto second = KAZ_TRY(half(first));
  return std::to_string(second);
}

TEST(Try, ReturnsTheValue) {
  const auto text = quarter_text(12);
  ASSERT_TRUE(text.has_value());
  EXPECT_EQ(*text, "3");
}

TEST(Try, ReturnsTheFirstErrorWithItsFault) {
  const auto first = quarter_text(7), second = quarter_text(6);
  ASSERT_FALSE(first.has_value());
  EXPECT_EQ(first.error().message, "7 is odd");
  EXPECT_EQ(first.error().fault, Fault::usage);
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().message, "3 is odd");
}

TEST(Try, OfVoidIsAStatement) {
  const auto both = [](int a, int b) -> Result<void> {
    KAZ_TRY(expect_even(a));
    KAZ_TRY(expect_even(b));
    return {};
  };
  EXPECT_TRUE(both(2, 4).has_value());
  EXPECT_EQ(both(2, 5).error().message, "5 is odd");
  EXPECT_EQ(both(3, 5).error().message, "3 is odd");
}

TEST(Try, EvaluatesOnceAndNothingBehindAnError) {
  int calls = 0, behind = 0;
  const auto counted = [&](int number) -> Result<int> {
    const int value = KAZ_TRY((++calls, half(number)));
    ++behind;
    return value;
  };
  EXPECT_EQ(counted(8).value(), 4);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(behind, 1);
  EXPECT_FALSE(counted(9).has_value());
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(behind, 1);
}

TEST(Try, MovesFromATemporaryAndCopiesFromAVariable) {
  const auto made = []() -> Result<std::unique_ptr<int>> { return std::make_unique<int>(5); };
  const auto moved = [&]() -> Result<int> {
    const auto owner = KAZ_TRY(made());
    return *owner;
  };
  EXPECT_EQ(moved().value(), 5);
  Result<std::string> kept = std::string(100, 'x');
  const auto copied = [&]() -> Result<std::size_t> {
    const auto copy = KAZ_TRY(kept);
    return copy.size();
  };
  EXPECT_EQ(copied().value(), 100u);
  EXPECT_EQ(kept->size(), 100u);
  kept = fail(Fault::failed, std::string(100, 'y'));
  EXPECT_FALSE(copied().has_value());
  EXPECT_EQ(kept.error().message.size(), 100u);
}

TEST(Try, NestsInItsOwnArgument) {
  const auto quarter = [](int number) -> Result<int> {
    return KAZ_TRY(half(KAZ_TRY(half(number))));
  };
  EXPECT_EQ(quarter(20).value(), 5);
  EXPECT_EQ(quarter(10).error().message, "5 is odd");
}

}  // namespace
}  // namespace kaz
