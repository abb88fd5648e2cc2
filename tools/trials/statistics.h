// Confidence of success rates, and statistics of measurements.
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
// succession, and statistical inference", J. Am. Stat. Assoc. 22 (1927). 0 to 1 where n is 0.
Interval wilson(std::uint64_t successes, std::uint64_t n);

// The smallest of the values that is not less than a fraction q (0..1) of them; 0 without values.
double quantile(std::vector<double> values, double q);

struct Summary {
  double mean = 0;
  double sigma = 0;  // of the sample, n - 1 degrees of freedom; 0 for a single value
  double max = 0;
};

// Zeros without values.
Summary summarize(const std::vector<double>& values);

// Signed errors of one quantity. Every statistic is 0 without values.
class Errors {
 public:
  void add(double error) { values_.push_back(error); }
  std::size_t count() const { return values_.size(); }
  bool empty() const { return values_.empty(); }
  double mean() const;
  double sigma() const;  // around the mean, of the population (n)
  double rms() const;
  double max() const;                        // of the absolute values
  double percentile(double fraction) const;  // of the absolute values, nearest rank of n - 1; 0..1

 private:
  std::vector<double> values_;
};

}  // namespace kaz::trials
