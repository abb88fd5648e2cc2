// Residuals of the servo model over many logs, summed up for a fit.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/fit_sums.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

namespace kaz::hil {
namespace {

constexpr double kRobust = 5e-3;  // rad: larger residuals count by their size, not by their square
constexpr double kCurrentRad = 0.02;  // a current wrong by all of it counts as much as this angle

double robust_cost(const Eigen::VectorXd& residuals) {
  return (residuals.array().square() + kRobust * kRobust).sqrt().sum();
}

double current_weight(const ServoLog& log) {
  if (!log.has_current) return 0;
  double square = 0;
  for (const ServoSample& one : log.samples) square += one.current_a * one.current_a;
  const double rms = std::sqrt(square / static_cast<double>(log.samples.size()));
  return rms > 0 ? kCurrentRad / rms : 0;
}

}  // namespace

FitLogs::FitLogs(int model, std::vector<const ServoLog*> logs, const std::vector<std::string>& rigs,
                 int threads, const std::function<bool()>& stopped)
    : model_(model),
      infos_(servo_model::servo_params(model)),
      threads_(threads),
      stopped_(stopped) {
  for (const ServoLog* log : logs)
    entries_.push_back(
        {log, static_cast<std::size_t>(std::ranges::find(rigs, log->rig()) - rigs.begin()),
         current_weight(*log)});
}

double FitLogs::cost(const FitPoint& point) const {
  std::vector<double> parts(entries_.size());
  for_each([&](std::size_t i) { parts[i] = robust_cost(residuals(entries_[i], point)); });
  double sum = 0;  // in order, so that the number of threads does not matter
  for (const double part : parts) sum += part;
  return sum;
}

FitSums FitLogs::sums(const FitPoint& point) const {
  std::vector<FitSums> parts(entries_.size());
  for_each([&](std::size_t i) { parts[i] = sums_of(entries_[i], point); });
  const auto p = static_cast<Eigen::Index>(infos_.size());
  const Eigen::Index n = p + static_cast<Eigen::Index>(point.zeros.size());
  FitSums all{0, Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].gradient.size() == 0) continue;  // stopped
    std::vector<Eigen::Index> place;
    for (Eigen::Index k = 0; k < p; ++k) place.push_back(k);
    place.push_back(p + static_cast<Eigen::Index>(entries_[i].rig));
    all.cost += parts[i].cost;
    all.square(place, place) += parts[i].square;
    all.gradient(place) += parts[i].gradient;
  }
  return all;
}

// Model less reading of each sample, then of each current; weighted.
Eigen::VectorXd FitLogs::residuals(const Entry& entry, const FitPoint& point) const {
  const std::vector<ServoSample>& samples = entry.log->samples;
  const Prediction made = predict(model_, point.params, *entry.log, point.zeros[entry.rig]);
  const auto n = static_cast<Eigen::Index>(samples.size());
  Eigen::VectorXd all(entry.current_weight > 0 ? 2 * n : n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    all[i] = made.position_rad[k] - samples[k].position_rad;
    if (entry.current_weight > 0)
      all[n + i] = entry.current_weight * (made.current_a[k] - samples[k].current_a);
  }
  return all;
}

// The derivatives are differences of predictions, one-sided where a bound is near.
FitSums FitLogs::sums_of(const Entry& entry, const FitPoint& point) const {
  const Eigen::VectorXd now = residuals(entry, point);
  const auto p = static_cast<Eigen::Index>(infos_.size());
  Eigen::MatrixXd slopes(now.size(), p + 1);
  for (Eigen::Index i = 0; i <= p; ++i) {
    FitPoint moved = point;
    double scale = kZeroScale, step = 0.02 * kZeroScale;
    if (i < p) {
      const ServoParamInfo& info = infos_[static_cast<std::size_t>(i)];
      scale = info.scale;
      step = 0.02 * info.scale;
      if (point.params.*info.at + step > info.high) step = -step;
      moved.params.*info.at += step;
    } else {
      moved.zeros[entry.rig] += step;
    }
    slopes.col(i) = (residuals(entry, moved) - now) * (scale / step);
  }
  const Eigen::VectorXd weights = (now.array().square() + kRobust * kRobust).sqrt().inverse();
  return {robust_cost(now), slopes.transpose() * weights.asDiagonal() * slopes,
          slopes.transpose() * weights.cwiseProduct(now)};
}

void FitLogs::for_each(const std::function<void(std::size_t)>& work) const {
  std::atomic<std::size_t> next = 0;
  const auto run = [&] {
    for (std::size_t i = next++; i < entries_.size() && !stopped_(); i = next++) work(i);
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < threads_ && static_cast<std::size_t>(i) < entries_.size(); ++i)
    others.emplace_back(run);
  run();
}

}  // namespace kaz::hil
