// Statistics of what was measured many times.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// The value that a share of the samples does not exceed; NaN of none.
double quantile(std::vector<double> samples, double share);
// NaN of fewer than two.
double standard_deviation(const std::vector<double>& samples);
// Of the median of samples that scatter like a normal distribution.
double median_error(const std::vector<double>& samples);

using Points = std::vector<std::pair<double, double>>;

// y = at_zero + slope x, by least squares, with the standard errors that the points' own scatter
// gives. NaN where no line can be laid.
struct Line {
  double at_zero = 0, slope = 0;
  double at_zero_error = 0, slope_error = 0;
  double worst = 0;  // largest distance of a point from it, in y
  double operator()(double x) const { return at_zero + slope * x; }
};
Line fit_line(const Points& points);

// NaN of none.
struct Mean {
  double value = 0, error = 0;  // standard error; 0 of one
};
Mean mean_of(const std::vector<double>& samples);

// Outline of the columns of a histogram, from zero to zero.
Series histogram(const std::string& name, const std::vector<double>& samples, int columns);
// An upright dashed line where a limit stands.
Series limit_line(const std::string& name, double x, double height);

}  // namespace kaz::hil
