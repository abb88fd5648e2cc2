// Fits factors of stated quantities, for groups of logs and for single logs.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/input_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "hil/servo/fitter.h"

namespace kaz::hil {
namespace {

constexpr std::size_t kMostChecked = 160;  // logs; more would only take longer
constexpr std::size_t kMostGroups = 12;    // of one quantity
// Fewer logs of a group would fit their factor without any error, and show no spread.
constexpr std::ptrdiff_t kFewestLogs = 3;
const double kLeastFactor = std::log(1.15);
constexpr double kLeastSigmas = 4;
// Multiples of the median error of a motion. A log with a larger error than the first is examined. A value is
// wrong if it brings the error below half, and below the second.
constexpr double kFarError = 2.5, kNearError = 1.5;
constexpr double kLeastError = 0.01;  // rad: smaller errors are not examined

const std::string kLogsWith = "logs with ";

std::string formatted(const char* form, double value) {
  char text[80];
  std::snprintf(text, sizeof text, form, value);
  return text;
}

double middle_of(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

// Groups of logs that share a stated value, for one quantity.
struct Kind {
  Stated quantity;
  std::string name;
  std::vector<std::string> groups = {};
  std::vector<std::ptrdiff_t> logs = {};  // number of logs of each group
  std::size_t first = 0;                  // index of the first group's scale
};

std::string group_of(const Kind& kind, const ServoLog& log) {
  return kind.quantity == Stated::gain ? formatted("gain %.4g per rad", log.gain_per_rad)
                                       : log.rig();
}

// Kinds with at least two groups, and the index of each scale.
std::vector<Kind> kinds_of(const std::vector<const ServoLog*>& logs) {
  std::vector<Kind> kinds;
  std::size_t scales = 0;
  for (Kind kind : {Kind{Stated::gain, "gain"}, Kind{Stated::weight, "weight (mass or length)"},
                    Kind{Stated::inertia, "inertia"}}) {
    for (const ServoLog* log : logs) {
      const std::string group = group_of(kind, *log);
      const auto at = std::ranges::find(kind.groups, group) - kind.groups.begin();
      if (at == std::ssize(kind.groups)) {
        kind.groups.push_back(group);
        kind.logs.push_back(0);
      }
      ++kind.logs[static_cast<std::size_t>(at)];
    }
    if (kind.groups.size() < 2 || kind.groups.size() > kMostGroups) continue;
    kind.first = scales;
    scales += kind.groups.size();
    kinds.push_back(std::move(kind));
  }
  return kinds;
}

// Covariance of the unknowns; each log is one independent block.
Eigen::MatrixXd covariance_of(const std::vector<FitSums>& parts) {
  const Eigen::Index n = parts.front().gradient.size();
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(n, n), spread = square;
  for (const FitSums& part : parts) {
    square += part.square;
    spread += part.gradient * part.gradient.transpose();
  }
  // A factor common to all groups has no effect beside the parameters; the small prior makes it 0.
  square.diagonal().array() += 1e-7 * square.trace() / static_cast<double>(n) + 1e-300;
  const Eigen::MatrixXd inverse = square.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  return inverse * spread * inverse;
}

// Adds the groups of a kind whose factor differs from the others.
void compare_groups(const Kind& kind, const FitPoint& point, const Eigen::MatrixXd& covariance,
                    std::vector<WrongInput>& wrong) {
  const std::size_t count = kind.groups.size();
  const Eigen::Index n = covariance.rows(),
                     first = n - static_cast<Eigen::Index>(point.scales.size() - kind.first);
  const std::vector<double> scales(
      point.scales.begin() + static_cast<std::ptrdiff_t>(kind.first),
      point.scales.begin() + static_cast<std::ptrdiff_t>(kind.first + count));
  for (std::size_t i = 0; i < count; ++i) {
    // Difference from the mean of the others, for its variance.
    Eigen::VectorXd contrast = Eigen::VectorXd::Zero(n);
    contrast.segment(first, static_cast<Eigen::Index>(count)).array() =
        -1.0 / static_cast<double>(count - 1);
    contrast[first + static_cast<Eigen::Index>(i)] = 1;
    const double sigma = kLogScale * std::sqrt(contrast.dot(covariance * contrast));
    const double change = scales[i] - (count == 2 ? scales[1 - i] : middle_of(scales));
    if (kind.logs[i] < kFewestLogs || (count == 2 && kind.logs[1 - i] < kFewestLogs)) continue;
    if (!(std::abs(change) > std::max(kLeastFactor, kLeastSigmas * sigma))) continue;
    wrong.push_back({kLogsWith + kind.groups[i], kind.name, std::exp(change), sigma,
                     count == 2 ? kind.groups[1 - i] : ""});
    if (count == 2) return;
  }
}

std::vector<WrongInput> wrong_groups(const ServoFit& fit, const std::vector<ServoLog>& all,
                                     const ServoFitOptions& options) {
  const auto logs = some_logs(pointers_to(all), kMostChecked);
  const std::vector<Kind> kinds = kinds_of(logs);
  if (kinds.empty()) return {};
  std::vector<FitLog> scaled;
  for (const ServoLog* log : logs) {
    FitLog one{log};
    for (const Kind& kind : kinds) {
      const auto at = std::ranges::find(kind.groups, group_of(kind, *log)) - kind.groups.begin();
      one.scaled.push_back({kind.quantity, kind.first + static_cast<std::size_t>(at)});
    }
    scaled.push_back(std::move(one));
  }
  const std::vector<std::string> rigs = rigs_of(logs);
  FitPoint point{fit.params, {}};
  for (const std::string& rig : rigs)
    point.zeros.push_back(std::ranges::find(fit.zeros, rig, &RigZero::rig)->zero_rad);
  point.scales.assign(kinds.back().first + kinds.back().groups.size(), 0);
  const Fitter fitter(fit.model, scaled, rigs, fit_threads(options.threads), options.stopped,
                      point.scales.size());
  fitter.improve(point, 20, 1e-4);
  const std::vector<FitSums> parts = fitter.logs().parts(point);
  if (options.stopped()) return {};
  const Eigen::MatrixXd covariance = covariance_of(parts);
  std::vector<WrongInput> wrong;
  for (const Kind& kind : kinds) compare_groups(kind, point, covariance, wrong);
  return wrong;
}

// Mean error while the torque is on: a falling arm is bistable, and its error shows no wrong value.
double driven_error(const ServoFit& fit, const ServoLog& log) {
  const Prediction made = fit.predict(log);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    if (!log.samples[i].torque_on) continue;
    sum += std::abs(made.position_rad[i] - log.samples[i].position_rad);
    count += 1;
  }
  return count > 0 ? sum / count : 0;
}

// A value of one log that may be wrong, and the quantities that it changes.
struct Candidate {
  const char* name;
  std::vector<Stated> quantities;
};

WrongInput best_change(const ServoFit& fit, const ServoLog& log, double& least) {
  static const std::array<Candidate, 3> kCandidates{
      Candidate{"gain", {Stated::gain}},
      {"weight (mass or length)", {Stated::weight, Stated::inertia}},
      {"time stamps", {Stated::time}}};
  WrongInput best;
  for (const Candidate& one : kCandidates) {
    for (const double factor : {0.5, 0.6, 0.7, 0.77, 0.85, 1.18, 1.3, 1.43, 1.67, 2.0}) {
      ServoLog changed = log;
      for (const Stated quantity : one.quantities) scale_stated(changed, quantity, factor);
      const double error = driven_error(fit, changed);
      if (!(error < least)) continue;
      least = error;
      best = {log.name, one.name, factor, 0, ""};
    }
  }
  return best;
}

std::vector<WrongInput> wrong_logs(const ServoFit& fit, const std::vector<ServoLog>& logs) {
  std::map<std::string, std::vector<double>> by_motion;
  std::vector<double> errors;
  for (const ServoLog& log : logs) {
    errors.push_back(driven_error(fit, log));
    by_motion[log.motion].push_back(errors.back());
  }
  std::vector<WrongInput> wrong;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double usual = std::max(kLeastError / kFarError, middle_of(by_motion[logs[i].motion]));
    if (errors[i] <= kFarError * usual) continue;
    double least = std::min(0.5 * errors[i], kNearError * usual);
    const WrongInput one = best_change(fit, logs[i], least);
    if (!one.logs.empty()) wrong.push_back(one);
  }
  return wrong;
}

// True if the groups in `wrong` contain the log.
bool is_in_group(const std::vector<WrongInput>& wrong, const ServoLog& log) {
  return std::ranges::any_of(wrong, [&](const WrongInput& one) {
    return std::ranges::any_of(std::array{Stated::gain, Stated::weight}, [&](Stated quantity) {
      const std::string group = group_of({quantity, ""}, log);
      return one.logs == kLogsWith + group || one.other == group;
    });
  });
}

}  // namespace

std::vector<WrongInput> wrong_inputs(const ServoFit& fit, const std::vector<ServoLog>& logs,
                                     const ServoFitOptions& options) {
  std::vector<WrongInput> wrong = wrong_groups(fit, logs, options);
  std::vector<ServoLog> others;
  for (const ServoLog& log : logs)
    if (!is_in_group(wrong, log)) others.push_back(log);
  for (WrongInput& one : wrong_logs(fit, others)) wrong.push_back(std::move(one));
  if (options.stopped()) return {};
  return wrong;
}

std::string sentence_of(const WrongInput& one) {
  std::string text = one.logs + ": the " + one.quantity + " fits " + formatted("%.2f", one.factor) +
                     " times the stated value";
  if (!one.other.empty()) text += " relative to " + one.other + "; check both";
  return text;
}

}  // namespace kaz::hil
