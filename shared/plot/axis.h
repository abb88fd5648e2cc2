// Round numbers for an axis.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kaz::plot {

struct Axis {
  double low = 0, high = 1;
  double step = 0.2;  // 1, 2 or 5 times a power of ten

  std::vector<double> ticks() const;
  std::string label(double value) const;  // as many decimals as the step needs
};

// About `count` ticks. With `widen`, the ends move out to whole steps; otherwise they stay. Ends
// that are equal, in the wrong order or not finite give a range that can be drawn nevertheless.
Axis make_axis(double low, double high, int count, bool widen);

}  // namespace kaz::plot
