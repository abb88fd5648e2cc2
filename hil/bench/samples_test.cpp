// Quantiles, lines and histograms of known samples.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "hil/bench/samples.h"

namespace kaz::hil {
namespace {

TEST(Samples, Quantiles) {
  std::vector<double> samples;
  for (int i = 100; i >= 1; --i) samples.push_back(i);
  EXPECT_EQ(quantile(samples, 0.5), 50);
  EXPECT_EQ(quantile(samples, 0.99), 99);
  EXPECT_EQ(quantile(samples, 1), 100);
  EXPECT_EQ(quantile(samples, 0), 1);
  EXPECT_EQ(quantile({7}, 0.5), 7);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Samples, Deviation) {
  EXPECT_DOUBLE_EQ(standard_deviation({1, 3, 1, 3}), std::sqrt(4.0 / 3));
  EXPECT_EQ(standard_deviation({5, 5, 5}), 0);
  EXPECT_TRUE(std::isnan(standard_deviation({5})));
  EXPECT_EQ(median_error({5, 5, 5}), 0);
  EXPECT_EQ(median_error({}), 0);
}

TEST(Samples, ALineIsFoundAgain) {
  std::vector<std::pair<double, double>> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(i, 3 - 0.25 * i);
  const Line exact = fit_line(points);
  EXPECT_NEAR(exact.at_zero, 3, 1e-12);
  EXPECT_NEAR(exact.slope, -0.25, 1e-12);
  EXPECT_NEAR(exact.slope_error, 0, 1e-12);
  for (int i = 0; i < 50; ++i) points[static_cast<std::size_t>(i)].second += i % 2 ? 0.1 : -0.1;
  const Line rough = fit_line(points);
  EXPECT_NEAR(rough.slope, -0.25, 3 * rough.slope_error);
  EXPECT_NEAR(rough.slope_error, 0.1 / std::sqrt(50 * 49 * 51 / 12.0), 2e-4);
  EXPECT_TRUE(std::isnan(fit_line({{0, 0}, {1, 1}}).slope));
  EXPECT_TRUE(std::isnan(fit_line({{1, 0}, {1, 1}, {1, 2}}).slope));
}

TEST(Samples, HistogramsCountAll) {
  const Series series = histogram("h", {0, 0.1, 0.9, 1.0, 0.5}, 2);
  // From zero, two columns of two points, to zero.
  ASSERT_EQ(series.points.size(), 6u);
  EXPECT_EQ(series.points.front(), std::pair(0.0, 0.0));
  EXPECT_EQ(series.points[1], std::pair(0.0, 2.0));
  EXPECT_EQ(series.points[3], std::pair(0.5, 3.0));
  EXPECT_EQ(series.points.back(), std::pair(1.0, 0.0));
  EXPECT_EQ(histogram("same", {7, 7, 7}, 10).points.size(), 4u);
  EXPECT_EQ(histogram("same", {7, 7, 7}, 10).points[1].second, 3);
  EXPECT_TRUE(histogram("none", {}, 10).points.empty());
}

}  // namespace
}  // namespace kaz::hil
