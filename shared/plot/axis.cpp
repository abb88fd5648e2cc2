// Axis ticks at 1, 2 and 5 times powers of ten.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace kaz::plot {

Axis make_axis(double low, double high, int count, bool widen) {
  if (!std::isfinite(low) || !std::isfinite(high)) {
    low = 0;
    high = 1;
  }
  if (high < low) std::swap(low, high);
  if (!(high - low > 1e-9 * std::max(std::abs(low), std::abs(high))) || high == low) {
    const double margin = std::max(std::abs(low) * 0.1, 0.5);
    low -= margin;
    high += margin;
  }
  const double raw = (high - low) / std::max(count, 1);
  const double power = std::pow(10, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * 0.999) {
      step = factor * power;
      break;
    }
  }
  if (widen) {
    low = std::floor(low / step + 1e-9) * step;
    high = std::ceil(high / step - 1e-9) * step;
  }
  return {low, high, step};
}

std::vector<double> Axis::ticks() const {
  std::vector<double> values;
  const double first = std::ceil(low / step - 1e-6);
  for (int i = 0; i < 1000; ++i) {
    const double value = (first + i) * step;
    if (value > high + 1e-6 * step) break;
    values.push_back(value);
  }
  return values;
}

std::string Axis::label(double value) const {
  const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
  std::array<char, 64> text{};
  const double shown = std::abs(value) < 1e-9 * step ? 0 : value;
  std::snprintf(text.data(), text.size(), "%.*f", decimals, shown);
  std::string label = text.data();
  if (label[0] == '-') label.replace(0, 1, "\u2212");  // a minus sign, as wide as a plus
  return label;
}

}  // namespace kaz::plot
