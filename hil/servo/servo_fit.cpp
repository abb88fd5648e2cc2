// Fits motor, friction and control law of a servo to logs of a pendulum.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "hil/servo/fit_sums.h"

namespace kaz::hil {
namespace {

// Largest numbers of logs of the search from several starting points, and of the search from the best one.
// Only the last rounds use all logs.
constexpr std::size_t kCoarseLogs = 40, kMediumLogs = 160;

// One unknown of a fit: a parameter of the model or a rig's zero.
struct Unknown {
  double low, high, scale;
};

class Fitter {
 public:
  Fitter(int model, std::vector<const ServoLog*> logs, const std::vector<std::string>& rigs,
         int threads, const std::function<bool()>& stopped)
      : infos_(servo_model::servo_params(model)),
        logs_(model, std::move(logs), rigs, threads, stopped),
        stopped_(stopped) {
    for (const ServoParamInfo& info : infos_)
      unknowns_.push_back({info.low, info.high, info.scale});
    unknowns_.resize(infos_.size() + rigs.size(), {-kMostZero, kMostZero, kZeroScale});
  }

  double cost(const FitPoint& point) const { return logs_.cost(point); }

  // Searches zeros only.
  void fix_params() { first_open_ = static_cast<Eigen::Index>(infos_.size()); }

  // Improves `point` by the Levenberg-Marquardt method within the bounds, until a round improves the cost by
  // less than the share `least`. Returns the cost.
  double improve(FitPoint& point, int rounds, double least) const {
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
      now = logs_.sums(point);
    }
    return now.cost;
  }

  // Fills in values and uncertainties.
  void judge(const FitPoint& point, ServoFit& fit, std::span<const std::string> rigs) const {
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
      return change < unknowns_[i].high - unknowns_[i].low
                 ? change
                 : std::numeric_limits<double>::infinity();
    };
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      const double value = point.params.*infos_[i].at, change = within(i);
      fit.fitted.push_back({&infos_[i], value, change, change < 0.5 * value});
    }
    for (std::size_t i = 0; i < rigs.size(); ++i)
      fit.zeros.push_back({rigs[i], point.zeros[i], within(infos_.size() + i), first_open_ > 0});
  }

 private:
  double& value_of(FitPoint& point, std::size_t i) const {
    return i < infos_.size() ? point.params.*infos_[i].at : point.zeros[i - infos_.size()];
  }

  // If a parameter is at a bound and the cost falls beyond the bound, the parameter stays.
  FitPoint stepped(const FitPoint& point, const FitSums& now, double damping) const {
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

  std::span<const ServoParamInfo> infos_;
  std::vector<Unknown> unknowns_;
  Eigen::Index first_open_ = 0;
  FitLogs logs_;
  const std::function<bool()>& stopped_;
};

// Starting points of the first model: typical motors.
std::vector<ServoParams> typical_motors() {
  std::vector<ServoParams> all;
  for (const double kt : {0.4, 1.2, 2.2}) {
    for (const double resistance : {2.5, 5.0}) {
      ServoParams one;
      one.kt = kt;
      one.resistance = resistance;
      one.armature = 0.012 * kt * kt;
      one.base = 0.04 * kt;
      one.viscous = 0.01 * kt;
      one.error_bias = 1e-3;
      one.delay = 0.01;
      one.slew = 8;
      one.lag = 3e-3;
      all.push_back(one);
    }
  }
  return all;
}

// The parameters of simpler models, as parameters of `model` that make the same friction.
std::vector<ServoParams> contained(int model, const std::vector<ServoFit>& before) {
  std::vector<ServoParams> all;
  for (const ServoFit& fit : before) {
    if (model == 3 && fit.model == 2) continue;  // M3 does not contain M2
    ServoParams one = fit.params;
    if (model >= 5 && fit.model < 5) {
      one.motor = one.external = one.load;
      one.motor_stribeck = one.external_stribeck = one.load_stribeck;
    }
    all.push_back(one);
  }
  return all;
}

// Starting points with some friction in every term, because the cost is flat where a term is 0.
std::vector<ServoParams> varied(int model, const std::vector<ServoParams>& simpler) {
  std::vector<ServoParams> all = simpler;
  for (ServoParams one : simpler) {
    if (model != 3 && one.stribeck == 0) {
      one.stribeck = 0.3 * one.base;
      one.base *= 0.7;
    }
    if (model == 3 || model == 4) one.load = std::max(0.05, one.load);
    if (model == 4) one.load_stribeck = std::max(0.05, 0.5 * one.load);
    if (model >= 5) {
      for (double ServoParams::*at :
           {&ServoParams::motor, &ServoParams::external, &ServoParams::motor_stribeck,
            &ServoParams::external_stribeck})
        one.*at = std::max(0.02, one.*at);
      one.motor *= 1.5;
    }
    if (model == 6) one.motor_quad = one.external_quad = 0.01;
    all.push_back(one);
  }
  return all;
}

std::vector<const ServoLog*> pointers(const std::vector<ServoLog>& logs) {
  std::vector<const ServoLog*> all;
  for (const ServoLog& log : logs) all.push_back(&log);
  return all;
}

// A fixed random choice: files often come sorted by motion, and a regular choice would miss some motions.
std::vector<const ServoLog*> some(std::vector<const ServoLog*> logs, std::size_t most) {
  std::mt19937 random(1);
  most = std::min(most, logs.size());
  for (std::size_t i = 0; i < most; ++i) std::swap(logs[i], logs[i + random() % (logs.size() - i)]);
  logs.resize(most);
  return logs;
}

// Rigs of the logs, in order of appearance, without those in `known`.
std::vector<std::string> rigs_of(const std::vector<ServoLog>& logs,
                                 const std::vector<std::string>& known = {}) {
  std::vector<std::string> rigs;
  for (const ServoLog& log : logs) {
    const std::string rig = log.rig();
    if (std::ranges::count(rigs, rig) == 0 && std::ranges::count(known, rig) == 0)
      rigs.push_back(rig);
  }
  return rigs;
}

// One fit of one model, and the start of later ones.
class Search {
 public:
  Search(const std::vector<ServoLog>& logs, const std::vector<ServoLog>& held_out,
         const ServoFitOptions& options)
      : logs_(logs), held_out_(held_out), options_(options), rigs_(rigs_of(logs)) {
    threads_ = options.threads > 0
                   ? options.threads
                   : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }

  Result<ServoFit> fit(int model, const std::vector<ServoFit>& before) {
    model_ = model;
    FitPoint best = rough_fit(before);
    const Fitter medium = fitter(kMediumLogs), fine = fitter(logs_.size());
    report(0.5);
    double cost = medium.cost(best);
    for (const ServoParams& params : contained(model, before)) {
      const FitPoint other{params, zeros_};
      const double there = medium.cost(other);
      if (!(there < cost)) continue;
      best = other;
      cost = there;
    }
    cost = medium.improve(best, 40, 3e-5);
    report(0.8);
    if (logs_.size() > kMediumLogs) cost = fine.improve(best, 3, 1e-4);
    zeros_ = best.zeros;
    ServoFit made;
    made.model = model;
    made.params = best.params;
    report(0.95);
    fine.judge(best, made, rigs_);
    fit_held_out_zeros(made);
    if (options_.stopped()) return fail(Fault::interrupted, "interrupted; nothing was fitted");
    made.fit = errors_of(made, logs_);
    if (!std::isfinite(cost) || made.fit.position_rad > 1)
      return fail(Fault::failed,
                  "no motor model fits these logs: check gain_per_rad and the weight, and check "
                  "that position_rad is about 0 while the arm hangs down");
    made.held_out = errors_of(made, held_out_);
    return made;
  }

 private:
  Fitter fitter(std::size_t most_logs) const {
    return {model_, some(pointers(logs_), most_logs), rigs_, threads_, options_.stopped};
  }

  // Searches from all starting points with some of the logs.
  FitPoint rough_fit(const std::vector<ServoFit>& before) const {
    const Fitter rough = fitter(kCoarseLogs);
    std::vector<FitPoint> from;
    for (const ServoParams& params :
         before.empty() ? typical_motors() : varied(model_, contained(model_, before)))
      from.push_back({params, zeros_});
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < from.size(); ++i) {
      report(0.4 * static_cast<double>(i) / static_cast<double>(from.size()));
      order.emplace_back(rough.improve(from[i], 5, 1e-2), i);
    }
    std::ranges::sort(order);
    order.resize(std::min<std::size_t>(2, order.size()));
    for (auto& [cost, at] : order) {
      report(0.5);
      cost = rough.improve(from[at], 40, 1e-4);
    }
    std::ranges::sort(order);
    return from[order.front().second];
  }

  void report(double share) const {
    const auto models = options_.models;
    const auto done = std::ranges::find(models, model_) - models.begin();
    if (options_.progress)
      options_.progress((static_cast<double>(done) + share) / static_cast<double>(models.size()),
                        "model M" + std::to_string(model_));
  }

  void fit_held_out_zeros(ServoFit& made) const {
    const std::vector<std::string> rigs = rigs_of(held_out_, rigs_);
    if (rigs.empty()) return;
    std::vector<const ServoLog*> logs;
    for (const ServoLog& log : held_out_)
      if (std::ranges::count(rigs, log.rig()) > 0) logs.push_back(&log);
    Fitter fitter(made.model, logs, rigs, threads_, options_.stopped);
    fitter.fix_params();
    FitPoint point{made.params, std::vector<double>(rigs.size(), 0)};
    fitter.improve(point, 20, 1e-4);
    ServoFit zeros;
    fitter.judge(point, zeros, rigs);
    made.zeros.insert(made.zeros.end(), zeros.zeros.begin(), zeros.zeros.end());
  }

  const std::vector<ServoLog>& logs_;
  const std::vector<ServoLog>& held_out_;
  const ServoFitOptions& options_;
  std::vector<std::string> rigs_;
  std::vector<double> zeros_ = std::vector<double>(rigs_.size(), 0);
  int threads_ = 1, model_ = 1;
};

}  // namespace

double ServoFit::zero_of(const ServoLog& log) const {
  const std::string rig = log.rig();
  for (const RigZero& one : zeros)
    if (one.rig == rig) return one.zero_rad;
  return 0;
}

LogErrors errors_of(const ServoFit& fit, const std::vector<ServoLog>& logs) {
  LogErrors errors;
  double samples = 0, current = 0, currents = 0;
  for (const ServoLog& log : logs) {
    const Prediction made = fit.predict(log);
    for (std::size_t i = 0; i < log.samples.size(); ++i) {
      const ServoSample& read = log.samples[i];
      errors.position_rad += std::abs(made.position_rad[i] - read.position_rad);
      samples += 1;
      if (!log.has_current) continue;
      current += std::abs(made.current_a[i] - read.current_a);
      currents += std::abs(read.current_a);
    }
  }
  if (samples > 0) errors.position_rad /= samples;
  if (currents > 0) errors.current_share = current / currents;
  return errors;
}

Result<std::vector<ServoFit>> fit_servo(const std::vector<ServoLog>& logs,
                                        const std::vector<ServoLog>& held_out,
                                        const ServoFitOptions& options) {
  if (logs.empty()) return fail(Fault::usage, "no logs to fit: give at least one log");
  Search search(logs, held_out, options);
  std::vector<ServoFit> all;
  for (const int model : options.models) all.push_back(KAZ_TRY(search.fit(model, all)));
  return all;
}

}  // namespace kaz::hil
