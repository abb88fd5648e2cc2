// Confidence of success rates, and statistics of measurements.
// SPDX-License-Identifier: Apache-2.0
#include "tools/trials/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kaz::trials {

Interval wilson(std::uint64_t successes, std::uint64_t n) {
  if (n == 0) return {0, 1};
  constexpr double z = 1.959963984540054;  // 97.5 % of the normal distribution
  const double count = static_cast<double>(n), p = static_cast<double>(successes) / count;
  // (p + z^2/2n -+ z sqrt(p (1 - p) / n + z^2/4n^2)) / (1 + z^2/n)
  const double middle = p + z * z / (2 * count);
  const double half = z * std::sqrt(p * (1 - p) / count + z * z / (4 * count * count));
  const double scale = 1 + z * z / count;
  return {std::max(0.0, (middle - half) / scale), std::min(1.0, (middle + half) / scale)};
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(q * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

Summary summarize(const std::vector<double>& values) {
  Summary out;
  if (values.empty()) return out;
  const auto count = static_cast<double>(values.size());
  out.mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  for (const double value : values) out.sigma += std::pow(value - out.mean, 2);
  out.sigma = values.size() > 1 ? std::sqrt(out.sigma / (count - 1)) : 0;
  out.max = *std::max_element(values.begin(), values.end());
  return out;
}

double Errors::mean() const {
  if (empty()) return 0;
  return std::accumulate(values_.begin(), values_.end(), 0.0) / static_cast<double>(count());
}

double Errors::rms() const {
  double sum = 0;
  for (const double v : values_) sum += v * v;
  return empty() ? 0 : std::sqrt(sum / static_cast<double>(count()));
}

double Errors::sigma() const {
  if (empty()) return 0;
  // E[v^2] - E[v]^2; rounding can take it below 0.
  double sum = 0;
  for (const double v : values_) sum += v * v;
  const double m = mean();
  return std::sqrt(std::max(0.0, sum / static_cast<double>(count()) - m * m));
}

double Errors::max() const {
  double found = 0;
  for (const double v : values_) found = std::max(found, std::abs(v));
  return found;
}

double Errors::percentile(double fraction) const {
  if (empty()) return 0;
  std::vector<double> sizes;
  for (const double v : values_) sizes.push_back(std::abs(v));
  std::sort(sizes.begin(), sizes.end());
  return sizes[static_cast<std::size_t>(fraction * static_cast<double>(count() - 1) + 0.5)];
}

}  // namespace kaz::trials
