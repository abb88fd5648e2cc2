// Quantiles, lines, histograms.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kaz::hil {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double mean(const std::vector<double>& samples) {
  double sum = 0;
  for (const double sample : samples) sum += sample;
  return sum / static_cast<double>(samples.size());
}

}  // namespace

double quantile(std::vector<double> samples, double share) {
  if (samples.empty()) return kNone;
  const double rank = std::ceil(share * static_cast<double>(samples.size())) - 1;
  const auto index =
      static_cast<std::ptrdiff_t>(std::clamp(rank, 0.0, static_cast<double>(samples.size() - 1)));
  std::nth_element(samples.begin(), samples.begin() + index, samples.end());
  return samples[static_cast<std::size_t>(index)];
}

double standard_deviation(const std::vector<double>& samples) {
  if (samples.size() < 2) return kNone;
  const double middle = mean(samples);
  double sum = 0;
  for (const double sample : samples) sum += (sample - middle) * (sample - middle);
  return std::sqrt(sum / static_cast<double>(samples.size() - 1));
}

double median_error(const std::vector<double>& samples) {
  if (samples.size() < 2) return 0;
  return 1.2533 * standard_deviation(samples) / std::sqrt(static_cast<double>(samples.size()));
}

Mean mean_of(const std::vector<double>& samples) {
  if (samples.empty()) return {kNone, kNone};
  const double error = samples.size() < 2 ? 0
                                          : standard_deviation(samples) /
                                                std::sqrt(static_cast<double>(samples.size()));
  return {mean(samples), error};
}

Line fit_line(const Points& points) {
  const auto count = static_cast<double>(points.size());
  double x_mean = 0, y_mean = 0;
  for (const auto& [x, y] : points) {
    x_mean += x / count;
    y_mean += y / count;
  }
  double xx = 0, xy = 0;
  for (const auto& [x, y] : points) {
    xx += (x - x_mean) * (x - x_mean);
    xy += (x - x_mean) * (y - y_mean);
  }
  if (points.size() < 3 || !(xx > 0)) return {kNone, kNone, kNone, kNone, kNone};
  Line line;
  line.slope = xy / xx;
  line.at_zero = y_mean - line.slope * x_mean;
  double rest = 0;
  for (const auto& [x, y] : points) {
    const double off = y - line(x);
    line.worst = std::max(line.worst, std::abs(off));
    rest += off * off;
  }
  const double sigma = std::sqrt(rest / (count - 2));
  line.slope_error = sigma / std::sqrt(xx);
  line.at_zero_error = sigma * std::sqrt(1 / count + x_mean * x_mean / xx);
  return line;
}

Series histogram(const std::string& name, const std::vector<double>& samples, int columns) {
  Series series{name, Series::Style::line, {}};
  if (samples.empty()) return series;
  const auto [smallest, largest] = std::minmax_element(samples.begin(), samples.end());
  const double range = *largest - *smallest;
  const double width = range > 0 ? range / columns : std::max(std::abs(*largest) / columns, 1e-9);
  std::vector<int> counts(static_cast<std::size_t>(range > 0 ? columns : 1));
  for (const double sample : samples) {
    const auto column = static_cast<std::size_t>((sample - *smallest) / width);
    ++counts[std::min(column, counts.size() - 1)];
  }
  const double left = range > 0 ? *smallest : *smallest - width / 2;
  series.points.emplace_back(left, 0);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    series.points.emplace_back(left + static_cast<double>(i) * width, counts[i]);
    series.points.emplace_back(left + static_cast<double>(i + 1) * width, counts[i]);
  }
  series.points.emplace_back(left + static_cast<double>(counts.size()) * width, 0);
  return series;
}

Series limit_line(const std::string& name, double x, double height) {
  return {name, Series::Style::dashed, {{x, 0}, {x, height}}};
}

}  // namespace kaz::hil
