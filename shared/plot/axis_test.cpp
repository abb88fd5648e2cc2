// Round numbers for any range.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "shared/plot/axis.h"

namespace kaz::plot {
namespace {

TEST(Axis, StepsAreOneTwoOrFive) {
  EXPECT_EQ(make_axis(0, 10, 10, true).step, 1);
  EXPECT_EQ(make_axis(0, 9.3, 5, true).step, 2);
  EXPECT_EQ(make_axis(0, 9.3, 5, true).high, 10);
  EXPECT_EQ(make_axis(-33, 41, 5, true).low, -40);
  EXPECT_DOUBLE_EQ(make_axis(0, 0.23, 5, true).step, 0.05);
  EXPECT_EQ(make_axis(0, 0.23, 5, true).label(0.05), "0.05");
  EXPECT_EQ(make_axis(0, 100, 5, true).label(20), "20");
  EXPECT_EQ(make_axis(-10, 10, 5, true).label(-5), "\u22125");
}

TEST(Axis, AnyEndsGiveARange) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [low, high] : {std::pair{0.0, 0.0},
                                  {5.0, 5.0},
                                  {3.0, -3.0},
                                  {inf, -inf},
                                  {std::nan(""), 1.0},
                                  {1e300, 1e300},
                                  {-1e-300, 1e-300}}) {
    const Axis axis = make_axis(low, high, 5, true);
    EXPECT_LT(axis.low, axis.high);
    EXPECT_TRUE(std::isfinite(axis.low) && std::isfinite(axis.high) && axis.step > 0);
    EXPECT_LT(axis.ticks().size(), 100U);
  }
}

}  // namespace
}  // namespace kaz::plot
