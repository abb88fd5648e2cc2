// Statistics of what was measured many times.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// The value that a share of the samples does not exceed; NaN of none.
double quantile(std::vector<double> samples, double share);
// NaN of fewer than two.
double standard_deviation(const std::vector<double>& samples);
// Of the median of samples that scatter like a normal distribution.
double median_error(const std::vector<double>& samples);

// y = offset + slope * x by least squares; NaN where no line can be laid.
struct Line {
  double offset, slope, slope_error;
};
Line fit_line(const std::vector<std::pair<double, double>>& points);

// Outline of the columns of a histogram, from zero to zero.
Series histogram(const std::string& name, const std::vector<double>& samples, int columns);
// An upright dashed line where a limit stands.
Series limit_line(const std::string& name, double x, double height);

}  // namespace kaz::hil
