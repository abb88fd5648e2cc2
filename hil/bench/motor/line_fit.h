// A straight line through points, by least squares, and how sure it is.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

namespace kaz::hil {

using Points = std::vector<std::pair<double, double>>;

// y = at_zero + slope x.
struct Line {
  double at_zero = 0, slope = 0;
  double at_zero_error = 0, slope_error = 0;  // standard errors, from the points' own scatter
  double worst = 0;                           // largest distance of a point from it, in y
  double operator()(double x) const { return at_zero + slope * x; }
};

// Failed (check.h) for fewer than two points, or all at one x.
Line fit_line(const Points& points);

struct Mean {
  double value = 0, error = 0;  // standard error
  double deviation = 0;         // standard deviation of one
};
// Failed if there is none.
Mean mean_of(const std::vector<double>& values);

}  // namespace kaz::hil
