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
// succession, and statistical inference", J. Am. Stat. Assoc. 22 (1927). If n is 0, returns the interval from
// 0 to 1.
Interval wilson(std::uint64_t successes, std::uint64_t n);

// Returns the quantile q (0..1) by the method of nearest rank. This quantile is the smallest value v for
// which at least a fraction q of all values is less than or equal to v. Returns 0 if there are no values.
double quantile(std::vector<double> values, double q);

struct Summary {
  double mean = 0;
  // Sample standard deviation with n - 1 degrees of freedom; 0 for a single value.
  double sigma = 0;
  double max = 0;
};

// All members of the result are 0 if there are no values.
Summary summarize(const std::vector<double>& values);

// Collects signed errors of one quantity. If there are no values, every statistic is 0.
class Errors {
 public:
  void add(double error) { values_.push_back(error); }
  std::size_t count() const { return values_.size(); }
  bool empty() const { return values_.empty(); }
  double mean() const;
  double sigma() const;  // population standard deviation, divisor n
  double rms() const;
  double max() const;  // largest absolute value
  // Percentile of the absolute values; `fraction`: 0..1. Returns the sorted value with the index `fraction` *
  // (count() - 1), rounded.
  double percentile(double fraction) const;

 private:
  std::vector<double> values_;
};

}  // namespace kaz::trials
