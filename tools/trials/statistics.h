// Confidence intervals of success rates, and statistics of measurements.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::trials {

struct Interval {
  double min = 0, max = 0;
};

// Wilson's 95 % confidence interval of a proportion: E. B. Wilson, "Probable inference, the law of
// succession, and statistical inference", J. Am. Stat. Assoc. 22 (1927). 0 to 1 if n is 0.
Interval wilson(std::uint64_t successes, std::uint64_t n);

// Quantile q (0..1) by nearest rank: the smallest value that is at least as large as a fraction q of the
// values. 0 without values.
double quantile(std::vector<double> values, double q);

struct Summary {
  double mean = 0;
  double sigma = 0;  // sample standard deviation, n - 1 degrees of freedom; 0 for a single value
  double max = 0;
};

// Returns zeros without values.
Summary summarize(const std::vector<double>& values);

// Signed errors of one quantity. Every statistic is 0 without values.
class Errors {
 public:
  void add(double error) { values_.push_back(error); }
  std::size_t count() const { return values_.size(); }
  bool empty() const { return values_.empty(); }
  double mean() const;
  double sigma() const;  // population standard deviation, divisor n
  double rms() const;
  double max() const;  // largest absolute value
  // Percentile of the absolute values; `fraction`: 0..1. Rank: fraction (n - 1), rounded.
  double percentile(double fraction) const;

 private:
  std::vector<double> values_;
};

}  // namespace kaz::trials
