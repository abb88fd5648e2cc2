// Least squares.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/motor/line_fit.h"

#include <algorithm>
#include <cmath>

#include "hil/report/check.h"

namespace kaz::hil {

Line fit_line(const Points& points) {
  const auto n = static_cast<double>(points.size());
  check(points.size() >= 2, "too few readings for a line");
  double x = 0, y = 0;
  for (const auto& [px, py] : points) {
    x += px / n;
    y += py / n;
  }
  double xx = 0, xy = 0;
  for (const auto& [px, py] : points) {
    xx += (px - x) * (px - x);
    xy += (px - x) * (py - y);
  }
  check(xx > 0, "all readings are of one point of the line");
  Line line;
  line.slope = xy / xx;
  line.at_zero = y - line.slope * x;
  double squares = 0;
  for (const auto& [px, py] : points) {
    const double off = py - line(px);
    line.worst = std::max(line.worst, std::abs(off));
    squares += off * off;
  }
  if (points.size() > 2) {
    const double sigma = std::sqrt(squares / (n - 2));
    line.slope_error = sigma / std::sqrt(xx);
    line.at_zero_error = sigma * std::sqrt(1 / n + x * x / xx);
  }
  return line;
}

Mean mean_of(const std::vector<double>& values) {
  check(!values.empty(), "nothing was read");
  const auto n = static_cast<double>(values.size());
  Mean mean;
  for (const double value : values) mean.value += value / n;
  double squares = 0;
  for (const double value : values) squares += (value - mean.value) * (value - mean.value);
  if (values.size() > 1) {
    mean.deviation = std::sqrt(squares / (n - 1));
    mean.error = mean.deviation / std::sqrt(n);
  }
  return mean;
}

}  // namespace kaz::hil
