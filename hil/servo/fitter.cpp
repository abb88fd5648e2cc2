// Levenberg-Marquardt search of the servo model's parameters.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/fitter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

namespace kaz::hil {

Fitter::Fitter(int model, const std::vector<FitLog>& logs, const std::vector<std::string>& rigs,
               int threads, const std::function<bool()>& stopped, std::size_t scales)
    : infos_(servo_model::servo_params(model)),
      logs_(model, logs, rigs, threads, stopped),
      stopped_(stopped) {
  for (const ServoParamInfo& info : infos_) unknowns_.push_back({info.low, info.high, info.scale});
  unknowns_.resize(infos_.size() + rigs.size(), {-kMostZero, kMostZero, kZeroScale});
  unknowns_.resize(unknowns_.size() + scales, {-kMostLogScale, kMostLogScale, kLogScale});
}

double Fitter::improve(FitPoint& point, int rounds, double least) const {
  FitSums now = logs_.sums(point);
  double damping = 1e-2;
  for (int round = 0; round < rounds && !stopped_(); ++round) {
    const double before = now.cost;
    bool better = false;
    for (int tries = 0; tries < 8 && !better; ++tries) {
      const FitPoint next = stepped(point, now, damping);
      const double cost = logs_.cost(next);
      better = std::isfinite(cost) && cost < now.cost && !stopped_();
      if (better) {
        point = next;
        now.cost = cost;
      }
      damping = std::clamp(better ? damping * 0.3 : damping * 4, 1e-9, 1e9);
    }
    if (!better || before - now.cost < least * before) break;
    if (round + 1 < rounds) now = logs_.sums(point);
  }
  return now.cost;
}

void Fitter::judge(const FitPoint& point, ServoFit& fit, std::span<const std::string> rigs) const {
  const FitSums now = logs_.sums(point);
  Eigen::MatrixXd square = now.square;
  const Eigen::Index n = square.rows();
  // The diagonal of a parameter without effect is 0; a small prior keeps the matrix regular.
  square.diagonal().array() += 1e-12 * square.trace() / static_cast<double>(n) + 1e-300;
  const Eigen::MatrixXd inverse = square.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  const auto within = [&](std::size_t i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double change =
        unknowns_[i].scale * std::sqrt(0.06 * now.cost * std::max(0.0, inverse(k, k)));
    return change < unknowns_[i].high - unknowns_[i].low ? change
                                                         : std::numeric_limits<double>::infinity();
  };
  for (std::size_t i = 0; i < infos_.size(); ++i) {
    const double value = point.params.*infos_[i].at, change = within(i);
    fit.fitted.push_back({&infos_[i], value, change, change < 0.5 * value});
  }
  for (std::size_t i = 0; i < rigs.size(); ++i)
    fit.zeros.push_back({rigs[i], point.zeros[i], within(infos_.size() + i), false});
}

double& Fitter::value_of(FitPoint& point, std::size_t i) const {
  if (i < infos_.size()) return point.params.*infos_[i].at;
  const std::size_t k = i - infos_.size();
  return k < point.zeros.size() ? point.zeros[k] : point.scales[k - point.zeros.size()];
}

// If a parameter is at a bound and the cost falls beyond the bound, the parameter stays.
FitPoint Fitter::stepped(const FitPoint& point, const FitSums& now, double damping) const {
  FitPoint next = point;
  std::vector<Eigen::Index> open;
  for (Eigen::Index i = first_open_; i < now.gradient.size(); ++i) {
    const Unknown& one = unknowns_[static_cast<std::size_t>(i)];
    const double value = value_of(next, static_cast<std::size_t>(i)), falls = -now.gradient(i);
    if ((value <= one.low && falls < 0) || (value >= one.high && falls > 0)) continue;
    open.push_back(i);
  }
  Eigen::MatrixXd matrix = now.square(open, open);
  matrix.diagonal() += damping * (matrix.diagonal().array() + 1e-9 * now.square.trace()).matrix();
  const Eigen::VectorXd change = matrix.ldlt().solve(-now.gradient(open));
  for (std::size_t k = 0; k < open.size(); ++k) {
    const auto i = static_cast<std::size_t>(open[k]);
    double& value = value_of(next, i);
    value = std::clamp(value + unknowns_[i].scale * change(static_cast<Eigen::Index>(k)),
                       unknowns_[i].low, unknowns_[i].high);
  }
  return next;
}

std::vector<FitLog> unscaled(const std::vector<const ServoLog*>& logs) {
  std::vector<FitLog> all;
  for (const ServoLog* log : logs) all.push_back({log});
  return all;
}

std::vector<std::string> rigs_of(const std::vector<const ServoLog*>& logs,
                                 const std::vector<std::string>& known) {
  std::vector<std::string> rigs;
  for (const ServoLog* log : logs) {
    const std::string rig = log->rig();
    if (std::ranges::count(rigs, rig) == 0 && std::ranges::count(known, rig) == 0)
      rigs.push_back(rig);
  }
  return rigs;
}

std::vector<const ServoLog*> pointers_to(const std::vector<ServoLog>& logs) {
  std::vector<const ServoLog*> all;
  for (const ServoLog& log : logs) all.push_back(&log);
  return all;
}

std::vector<const ServoLog*> some_logs(std::vector<const ServoLog*> logs, std::size_t most) {
  std::mt19937 random(1);
  most = std::min(most, logs.size());
  for (std::size_t i = 0; i < most; ++i) std::swap(logs[i], logs[i + random() % (logs.size() - i)]);
  logs.resize(most);
  return logs;
}

int fit_threads(int wanted) {
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace kaz::hil
