// Statistics of repeated measurements.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// Returns a quantile of the samples. For example, with 100 samples and a `share` of 0.9, the result is the
// 90th sample in ascending order. The rank is `share` (0 to 1) times the number of samples. A fractional rank
// is rounded up, and a rank of 0 counts as 1. Returns NaN if there are no samples.
double quantile(std::vector<double> samples, double share);
// Returns NaN for fewer than two samples.
double standard_deviation(const std::vector<double>& samples);
// Returns the standard error of the median of normally distributed samples; 0 for fewer than two samples.
double median_error(const std::vector<double>& samples);

using Points = std::vector<std::pair<double, double>>;

// A line y = at_zero + slope x, fitted by least squares. The standard errors are computed from the scatter of
// the points about the line.
struct Line {
  double at_zero = 0, slope = 0;
  double at_zero_error = 0, slope_error = 0;
  double worst = 0;  // largest distance of a point from the line, in y
  double operator()(double x) const { return at_zero + slope * x; }
};

// All members of the result are NaN if there are fewer than three points, or if all points have the same x.
Line fit_line(const Points& points);

// Mean of samples; NaN if there are no samples.
struct Mean {
  double value = 0, error = 0;  // standard error; 0 for one sample
};
Mean mean_of(const std::vector<double>& samples);

// Returns the outline of a histogram. The outline begins and ends at height 0.
Series histogram(const std::string& name, const std::vector<double>& samples, int columns);
// Returns a vertical dashed line at a limit.
Series limit_line(const std::string& name, double x, double height);

}  // namespace kaz::hil
