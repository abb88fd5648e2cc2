// Errors of poses and paths, means and bootstrap.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/contact/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shared/base/random.hpp"

namespace kaz::contact {
namespace {

constexpr std::size_t kBootstraps = 10'000;

// Percentiles 2.5 and 97.5 of statistic(indices) over samples of `count` indices with replacement.
template <class Statistic>
Interval bootstrap(std::size_t count, std::uint64_t seed, const Statistic& statistic) {
  if (count == 0) return {};
  Random random(seed);
  std::vector<std::size_t> indices(count);
  std::vector<double> all;
  for (std::size_t k = 0; k < kBootstraps; ++k) {
    for (std::size_t& i : indices) i = random.below(static_cast<std::uint32_t>(count));
    all.push_back(statistic(indices));
  }
  std::ranges::sort(all);
  return {all[kBootstraps / 40], all[kBootstraps - 1 - kBootstraps / 40]};
}

double sum_at(std::span<const double> values, const std::vector<std::size_t>& indices) {
  double sum = 0;
  for (const std::size_t i : indices) sum += values[i];
  return sum;
}

}  // namespace

double pose_error(const Pose& a, const Pose& b) {
  const double angle = a.turn.angularDistance(b.turn);
  return (a.at - b.at).squaredNorm() / (kHalf * kHalf) + angle * angle;
}

double path_error(const Path& measured, const Path& simulated) {
  double sum = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) sum += pose_error(measured[i], simulated[i]);
  return sum / static_cast<double>(measured.size());
}

double mean(std::span<const double> values) {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median(std::span<const double> values) {
  if (values.empty()) return 0;
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  return (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]) / 2;
}

Interval bootstrap_mean(std::span<const double> values, std::uint64_t seed) {
  return bootstrap(values.size(), seed, [&](const auto& indices) {
    return sum_at(values, indices) / static_cast<double>(values.size());
  });
}

Interval bootstrap_ratio(std::span<const double> a, std::span<const double> b, std::uint64_t seed) {
  return bootstrap(a.size(), seed,
                   [&](const auto& indices) { return sum_at(a, indices) / sum_at(b, indices); });
}

}  // namespace kaz::contact
