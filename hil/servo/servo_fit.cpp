// Fits motor, friction and control law of a servo to logs of a pendulum.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <set>

#include "hil/servo/fitter.h"

namespace kaz::hil {
namespace {

// Largest numbers of logs of the search from several starting points, and of the search from the best one.
// Only the last rounds use all logs.
constexpr std::size_t kCoarseLogs = 40, kMediumLogs = 160, kInnerLogs = 80;

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

std::string labeled(const char* form, double value) {
  char text[60];
  std::snprintf(text, sizeof text, form, value);
  return text;
}

// Leaves the logs out whose `key` is the middle one; nothing if all have the same.
template <typename Key>
std::optional<InnerSplit> split_by(const std::vector<ServoLog>& logs, Key ServoLog::*key,
                                   bool last) {
  std::set<Key> keys;
  for (const ServoLog& log : logs) keys.insert(log.*key);
  if (keys.size() < 2) return std::nullopt;
  const Key out = *std::next(keys.begin(),
                             static_cast<std::ptrdiff_t>(last ? keys.size() - 1 : keys.size() / 2));
  InnerSplit split;
  for (const ServoLog& log : logs)
    (log.*key == out ? split.left_out : split.fitted).push_back(&log);
  return split;
}

// One fit of one model, and the start of later ones.
class Search {
 public:
  Search(const std::vector<ServoLog>& logs, const std::vector<ServoLog>& held_out,
         const ServoFitOptions& options)
      : logs_(logs),
        held_out_(held_out),
        options_(options),
        rigs_(rigs_of(pointers_to(logs))),
        splits_(inner_splits(logs)),
        threads_(fit_threads(options.threads)) {}

  Result<ServoFit> fit(int model, const std::vector<ServoFit>& before) {
    model_ = model;
    FitPoint best = rough_fit(before);
    try_current_limits(best);
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
    set_held_out_zeros(made);
    if (options_.models.size() > 1) made.inner_rad = inner_error(best);
    if (options_.stopped()) return fail(Fault::interrupted, "interrupted; nothing was fitted");
    made.fit = errors_of(made, logs_);
    if (!std::isfinite(cost) || made.fit.position_rad > 1)
      return fail(Fault::failed,
                  "no motor model fits these logs: check gain_per_rad and the weight, and check "
                  "that position_rad is about 0 while the arm hangs down");
    made.held_out = errors_of(made, held_out_);
    made.held_out_own_zeros =
        made.own_zeros.empty() ? made.held_out : errors_of(made.with_own_zeros(), held_out_);
    return made;
  }

 private:
  Fitter fitter(std::size_t most_logs) const { return fitter(pointers_to(logs_), most_logs); }
  Fitter fitter(const std::vector<const ServoLog*>& logs, std::size_t most_logs) const {
    return {model_, unscaled(some_logs(logs, most_logs)), rigs_, threads_, options_.stopped};
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

  // The cost is flat while no current reaches the limit, so the search tries limits that act.
  void try_current_limits(FitPoint& best) const {
    if (best.params.most_current < ServoParams().most_current) return;
    const std::vector<const ServoLog*> logs = some_logs(pointers_to(logs_), kCoarseLogs);
    const Fitter rough = fitter(logs, logs.size());
    double largest = 0;
    for (const ServoLog* log : logs) {
      const Prediction made = predict(model_, best.params, *log, zero_in(best, *log));
      for (const double current : made.current_a) largest = std::max(largest, std::abs(current));
    }
    double cost = rough.improve(best, 3, 1e-3);
    for (const double share : {0.75, 0.5}) {
      FitPoint limited = best;
      limited.params.most_current = share * largest;
      const double there = rough.improve(limited, 6, 1e-3);
      // Without a clear gain, the limit would only make up for other errors.
      if (!(there < 0.98 * cost)) continue;
      best = limited;
      cost = there;
    }
  }

  double zero_in(const FitPoint& point, const ServoLog& log) const {
    const auto at = std::ranges::find(rigs_, log.rig()) - rigs_.begin();
    return point.zeros[static_cast<std::size_t>(at)];
  }

  // Error of the left-out logs of the inner splits. A rig without fitted logs has the mean zero.
  double inner_error(const FitPoint& best) const {
    double sum = 0;
    for (const InnerSplit& split : splits_) {
      FitPoint point = best;
      fitter(split.fitted, kInnerLogs).improve(point, 12, 3e-4);
      ServoFit inner;
      inner.model = model_;
      inner.params = point.params;
      for (const std::string& rig : rigs_of(split.fitted))
        inner.zeros.push_back(
            {rig,
             point.zeros[static_cast<std::size_t>(std::ranges::find(rigs_, rig) - rigs_.begin())]});
      add_mean_zeros(inner, rigs_of(split.left_out, rigs_of(split.fitted)));
      std::vector<ServoLog> left_out;
      for (const ServoLog* log : some_logs(split.left_out, kInnerLogs)) left_out.push_back(*log);
      sum += errors_of(inner, left_out).position_rad;
    }
    return splits_.empty() ? std::numeric_limits<double>::infinity()
                           : sum / static_cast<double>(splits_.size());
  }

  // Gives the rigs the mean zero of the others.
  static void add_mean_zeros(ServoFit& fit, const std::vector<std::string>& rigs) {
    double sum = 0;
    for (const RigZero& one : fit.zeros) sum += one.zero_rad;
    const double mean = fit.zeros.empty() ? 0 : sum / static_cast<double>(fit.zeros.size());
    for (const std::string& rig : rigs)
      fit.zeros.push_back({rig, mean, std::numeric_limits<double>::infinity(), true});
  }

  void set_held_out_zeros(ServoFit& made) const {
    const std::vector<std::string> rigs = rigs_of(pointers_to(held_out_), rigs_);
    if (rigs.empty()) return;
    add_mean_zeros(made, rigs);
    std::vector<const ServoLog*> logs;
    for (const ServoLog& log : held_out_)
      if (std::ranges::count(rigs, log.rig()) > 0) logs.push_back(&log);
    Fitter own(made.model, unscaled(logs), rigs, threads_, options_.stopped);
    own.fix_params();
    FitPoint point{made.params, std::vector<double>(rigs.size(), 0)};
    own.improve(point, 20, 1e-4);
    ServoFit zeros;
    own.judge(point, zeros, rigs);
    made.own_zeros = zeros.zeros;
    for (RigZero& one : made.own_zeros) one.held_out = true;
  }

  const std::vector<ServoLog>& logs_;
  const std::vector<ServoLog>& held_out_;
  const ServoFitOptions& options_;
  std::vector<std::string> rigs_;
  std::vector<InnerSplit> splits_;
  std::vector<double> zeros_ = std::vector<double>(rigs_.size(), 0);
  int threads_, model_ = 1;
};

}  // namespace

double ServoFit::zero_of(const ServoLog& log) const {
  const std::string rig = log.rig();
  for (const RigZero& one : zeros)
    if (one.rig == rig) return one.zero_rad;
  return 0;
}

ServoFit ServoFit::with_own_zeros() const {
  ServoFit copy = *this;
  for (RigZero& one : copy.zeros)
    for (const RigZero& own : own_zeros)
      if (own.rig == one.rig) one = own;
  return copy;
}

std::vector<InnerSplit> inner_splits(const std::vector<ServoLog>& logs) {
  std::vector<InnerSplit> all;
  if (auto gain = split_by(logs, &ServoLog::gain_per_rad, false)) {
    gain->name = labeled("gain %.4g per rad", gain->left_out[0]->gain_per_rad);
    all.push_back(std::move(*gain));
  }
  if (auto mass = split_by(logs, &ServoLog::mass_kg, false)) {
    mass->name = labeled("mass %.4g kg", mass->left_out[0]->mass_kg);
    all.push_back(std::move(*mass));
  }
  if (!all.empty()) return all;
  if (auto motion = split_by(logs, &ServoLog::motion, true)) {
    motion->name = "motion " + motion->left_out[0]->motion;
    all.push_back(std::move(*motion));
  }
  return all;
}

const ServoFit& chosen_fit(const std::vector<ServoFit>& fits) {
  const bool inner = std::isfinite(fits.front().inner_rad);
  const auto error = [inner](const ServoFit& fit) {
    return inner ? fit.inner_rad : fit.fit.position_rad;
  };
  double least = error(fits.front());
  for (const ServoFit& fit : fits) least = std::min(least, error(fit));
  return *std::ranges::find_if(fits,
                               [&](const ServoFit& fit) { return error(fit) <= 1.03 * least; });
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
