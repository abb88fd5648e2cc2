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

void scale_stated(ServoLog& log, Stated quantity, double factor) {
  const double start = log.samples[0].time_s;
  switch (quantity) {
    case Stated::gain:
      log.gain_per_rad *= factor;
      break;
    case Stated::weight:
      log.weight_nm = factor * log.gravity_nm();
      break;
    case Stated::inertia:
      log.inertia_kgm2 = factor * log.load_kgm2();
      break;
    case Stated::time:
      for (ServoSample& one : log.samples) one.time_s = start + factor * (one.time_s - start);
  }
}

FitLogs::FitLogs(int model, const std::vector<FitLog>& logs, const std::vector<std::string>& rigs,
                 int threads, const std::function<bool()>& stopped)
    : model_(model),
      infos_(servo_model::servo_params(model)),
      threads_(threads),
      stopped_(stopped) {
  for (const FitLog& one : logs)
    entries_.push_back(
        {one, static_cast<std::size_t>(std::ranges::find(rigs, one.log->rig()) - rigs.begin()),
         current_weight(*one.log)});
}

double FitLogs::cost(const FitPoint& point) const {
  std::vector<double> parts(entries_.size());
  for_each([&](std::size_t i) { parts[i] = robust_cost(residuals(entries_[i], point)); });
  double sum = 0;  // in order, so that the number of threads does not matter
  for (const double part : parts) sum += part;
  return sum;
}

std::vector<FitSums> FitLogs::parts(const FitPoint& point) const {
  std::vector<FitSums> parts(entries_.size());
  for_each([&](std::size_t i) { parts[i] = part_of(entries_[i], point); });
  return parts;
}

FitSums FitLogs::sums(const FitPoint& point) const {
  const auto n =
      static_cast<Eigen::Index>(infos_.size() + point.zeros.size() + point.scales.size());
  FitSums all{0, Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const FitSums& part : parts(point)) {
    if (part.gradient.size() == 0) continue;  // stopped
    all.cost += part.cost;
    all.square += part.square;
    all.gradient += part.gradient;
  }
  return all;
}

// Model less reading of each sample, then of each current; weighted.
Eigen::VectorXd FitLogs::residuals(const Entry& entry, const FitPoint& point) const {
  ServoLog scaled;
  const ServoLog* log = entry.fit.log;
  if (!entry.fit.scaled.empty()) {
    scaled = *log;
    for (const ScaledBy& one : entry.fit.scaled)
      scale_stated(scaled, one.quantity, std::exp(point.scales[one.at]));
    log = &scaled;
  }
  const std::vector<ServoSample>& samples = log->samples;
  const Prediction made = predict(model_, point.params, *log, point.zeros[entry.rig]);
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
FitSums FitLogs::part_of(const Entry& entry, const FitPoint& point) const {
  const Eigen::VectorXd now = residuals(entry, point);
  const std::size_t p = infos_.size(), zeros = point.zeros.size();
  std::vector<Eigen::Index> place;
  for (std::size_t i = 0; i < p; ++i) place.push_back(static_cast<Eigen::Index>(i));
  place.push_back(static_cast<Eigen::Index>(p + entry.rig));
  for (const ScaledBy& one : entry.fit.scaled)
    place.push_back(static_cast<Eigen::Index>(p + zeros + one.at));
  Eigen::MatrixXd slopes(now.size(), static_cast<Eigen::Index>(place.size()));
  for (std::size_t i = 0; i < place.size(); ++i) {
    constexpr double kStep = 0.02;  // in units of the unknown's scale
    FitPoint moved = point;
    double step = kStep;
    if (i < p) {
      const ServoParamInfo& info = infos_[i];
      if (point.params.*info.at + step * info.scale > info.high) step = -step;
      moved.params.*info.at += step * info.scale;
    } else if (i == p) {
      moved.zeros[entry.rig] += step * kZeroScale;
    } else {
      moved.scales[entry.fit.scaled[i - p - 1].at] += step * kLogScale;
    }
    slopes.col(static_cast<Eigen::Index>(i)) = (residuals(entry, moved) - now) / step;
  }
  const auto n = static_cast<Eigen::Index>(p + zeros + point.scales.size());
  FitSums part{robust_cost(now), Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  const Eigen::VectorXd weights = (now.array().square() + kRobust * kRobust).sqrt().inverse();
  part.square(place, place) = slopes.transpose() * weights.asDiagonal() * slopes;
  part.gradient(place) = slopes.transpose() * weights.cwiseProduct(now);
  return part;
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
