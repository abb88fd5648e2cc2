// How sure a share is, and where values lie.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace kaz::trials {

struct Interval {
  double least = 0, most = 0;
};

// Wilson's interval of a share at 95 %: E. B. Wilson, "Probable inference, the law of succession,
// and statistical inference", J. Am. Stat. Assoc. 22 (1927). 0 to 1 where n is 0.
Interval wilson(std::uint64_t successes, std::uint64_t n);

// The smallest of the values that a share q (0..1) of them does not exceed; 0 where there are none.
double quantile(std::vector<double> values, double q);

}  // namespace kaz::trials
