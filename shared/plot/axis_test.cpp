// Ticks at round numbers for any range.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/axis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace kaz::plot {
namespace {

using Labels = std::vector<std::string>;

Axis whole_steps(double low, double high, int count) {
  return Axis::linear(low, high, count, Axis::End::whole_step, Axis::End::whole_step);
}

Labels labels(const Axis& axis) {
  Labels all;
  for (const auto& tick : axis.ticks()) {
    if (!tick.label.empty()) all.push_back(tick.label);
  }
  return all;
}

// Ticks within the ends, each beyond the one before.
void expect_drawable(const Axis& axis) {
  EXPECT_LT(axis.ticks().size(), 100U);
  EXPECT_GE(labels(axis).size(), 2U);
  double before = -1e-6;
  for (const Axis::Tick& tick : axis.ticks()) {
    EXPECT_GT(tick.at, before);
    EXPECT_LT(tick.at, 1 + 1e-6);
    before = tick.at;
  }
}

TEST(Axis, StepsAreOneTwoOrFive) {
  EXPECT_EQ(labels(whole_steps(0, 10, 10)),
            (Labels{"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10"}));
  EXPECT_EQ(labels(whole_steps(0, 9.3, 5)), (Labels{"0", "2", "4", "6", "8", "10"}));
  EXPECT_EQ(whole_steps(0, 9.3, 5).at(10), 1);
  EXPECT_EQ(whole_steps(-33, 41, 5).at(-40), 0);
  EXPECT_EQ(labels(whole_steps(0, 0.23, 5)),
            (Labels{"0.00", "0.05", "0.10", "0.15", "0.20", "0.25"}));
  EXPECT_EQ(labels(whole_steps(0, 100, 5)), (Labels{"0", "20", "40", "60", "80", "100"}));
  EXPECT_EQ(labels(whole_steps(-10, 10, 5)), (Labels{"\u221210", "\u22125", "0", "5", "10"}));
}

TEST(Axis, EndsLieWhereTheyAreWanted) {
  const Axis limited = Axis::linear(0, 11.5, 5, Axis::End::exact, Axis::End::exact);
  EXPECT_EQ(limited.at(0), 0);
  EXPECT_EQ(limited.at(11.5), 1);
  EXPECT_EQ(labels(limited), (Labels{"0", "5", "10"}));
  const Axis above = Axis::linear(0.5, 9.3, 5, Axis::End::exact, Axis::End::whole_step);
  EXPECT_EQ(above.at(0.5), 0);
  EXPECT_EQ(above.at(10), 1);
  const Axis clear = Axis::linear(0, 100, 5, Axis::End::margin, Axis::End::margin);
  EXPECT_NEAR(clear.at(0), 0.02 / 1.04, 1e-12);
  EXPECT_NEAR(clear.at(100), 1.02 / 1.04, 1e-12);
  EXPECT_EQ(labels(clear), (Labels{"0", "20", "40", "60", "80", "100"}));
  // A single value moves only the end that may move.
  EXPECT_EQ(Axis::linear(0, 0, 5, Axis::End::exact, Axis::End::whole_step).at(0), 0);
  EXPECT_EQ(Axis::linear(0, -std::numeric_limits<double>::infinity(), 5, Axis::End::exact,
                         Axis::End::whole_step)
                .at(0),
            0);
}

TEST(Axis, AnyEndsGiveARange) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [low, high] : {std::pair{0.0, 0.0},
                                  {5.0, 5.0},
                                  {3.0, -3.0},
                                  {inf, -inf},
                                  {std::nan(""), 1.0},
                                  {1.0, inf},
                                  {1e300, 1e300},
                                  {-1e-300, 1e-300},
                                  {-1e308, 1e308},
                                  {5e-324, 1e-323}}) {
    SCOPED_TRACE(testing::Message() << low << " to " << high);
    for (const auto end : {Axis::End::exact, Axis::End::margin, Axis::End::whole_step}) {
      expect_drawable(Axis::linear(low, high, 5, end, end));
      expect_drawable(Axis::linear(low, high, 5, Axis::End::exact, end));
    }
    // Numbers as small as the smallest one have no others between them that could be ticks.
    if (low != 5e-324) expect_drawable(Axis::logarithmic(low, high));
  }
}

TEST(Axis, RoundNumbersAndCommonFactors) {
  EXPECT_EQ(labels(whole_steps(0, 1, 5)), (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  const Axis large = whole_steps(0, 4e6, 4);
  EXPECT_EQ(labels(large), (Labels{"0", "1", "2", "3", "4"}));
  EXPECT_EQ(large.factor(), "10⁶");
  const Axis small = whole_steps(0, 2e-5, 2);
  EXPECT_EQ(labels(small), (Labels{"0", "10", "20"}));
  EXPECT_EQ(small.factor(), "10⁻⁶");
  EXPECT_DOUBLE_EQ(small.at(1e-5), 0.5);
}

TEST(Axis, LogarithmicOnesHaveTheirTicksAtRoundNumbers) {
  EXPECT_EQ(labels(Axis::logarithmic(0.1, 20)),
            (Labels{"0.1", "0.2", "0.5", "1", "2", "5", "10", "20"}));
  EXPECT_EQ(labels(Axis::logarithmic(1, 1e6)),
            (Labels{"1", "10", "100", "1000", "10000", "10⁵", "10⁶"}));
  EXPECT_GE(labels(Axis::logarithmic(3, 4)).size(), 2u);
  EXPECT_LE(labels(Axis::logarithmic(1e-300, 1e300)).size(), 10u);
  const Axis axis = Axis::logarithmic(1, 100);
  EXPECT_NEAR(axis.at(10), 0.5, 1e-12);
  EXPECT_TRUE(axis.shows(1e-9));
  EXPECT_FALSE(axis.shows(0));
  EXPECT_TRUE(whole_steps(0, 1, 5).shows(-7));
  EXPECT_FALSE(whole_steps(0, 1, 5).shows(std::nan("")));
}

}  // namespace
}  // namespace kaz::plot
