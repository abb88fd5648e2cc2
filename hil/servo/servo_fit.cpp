// Fits motor and friction of a servo to logs of a pendulum.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

namespace kaz::hil {
namespace {

constexpr double kStep = 1e-3;        // s, of the model
constexpr double kAway = 100;         // rad: the model has diverged
constexpr double kSensor = 5e-4;      // rad, a sensor of 4096 steps a turn
constexpr double kCurrentRad = 0.02;  // a current wrong by all of it counts as much as this angle

double clamped(double value, double limit) {
  return std::clamp(value, -limit, limit);
}

// Reading less model of each sample, then of each current; weighted.
Eigen::VectorXd residuals(int model, const ServoParams& params, const std::vector<ServoLog>& logs) {
  std::vector<double> all;
  for (const ServoLog& log : logs) {
    const Prediction made = predict(model, params, log);
    const std::size_t n = log.samples.size();
    for (std::size_t i = 0; i < n; ++i)
      all.push_back(made.position_rad[i] - log.samples[i].position_rad);
    if (!log.has_current) continue;
    double square = 0;
    for (const ServoSample& one : log.samples) square += one.current_a * one.current_a;
    const double rms = std::sqrt(square / static_cast<double>(n));
    const double weight = rms > 0 ? kCurrentRad / rms : 0;
    for (std::size_t i = 0; i < n; ++i)
      all.push_back(weight * (made.current_a[i] - log.samples[i].current_a));
  }
  return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

class Fitter {
 public:
  Fitter(int model, const std::vector<ServoLog>& logs, const std::function<bool()>& stopped)
      : model_(model), infos_(servo_params(model)), logs_(logs), stopped_(stopped) {}

  // Levenberg and Marquardt's method within the bounds. The cost at `params`, which it betters.
  double improve(ServoParams& params, int rounds) const {
    Eigen::VectorXd now = residuals(model_, params, logs_);
    double cost = now.squaredNorm(), damping = 1e-2;
    for (int round = 0; round < rounds && !stopped_(); ++round) {
      const Eigen::MatrixXd slopes = jacobian(params, now);
      const Eigen::VectorXd gradient = slopes.transpose() * now;
      const Eigen::MatrixXd square = slopes.transpose() * slopes;
      bool better = false;
      double before = cost;
      for (int tries = 0; tries < 8 && !better; ++tries) {
        const ServoParams next = stepped(params, square, gradient, damping);
        const Eigen::VectorXd there = residuals(model_, next, logs_);
        const double cost_there = there.squaredNorm();
        better = std::isfinite(cost_there) && cost_there < cost;
        if (better) {
          params = next;
          now = there;
          cost = cost_there;
        }
        damping = std::clamp(better ? damping * 0.3 : damping * 4, 1e-9, 1e9);
      }
      if (!better || before - cost < 1e-5 * before) break;
    }
    return cost;
  }

  std::vector<FittedServoParam> judged(const ServoParams& params) const {
    const Eigen::VectorXd now = residuals(model_, params, logs_);
    const Eigen::MatrixXd slopes = jacobian(params, now);
    Eigen::MatrixXd square = slopes.transpose() * slopes;
    const Eigen::Index n = square.rows();
    // Parameters without any effect have no column: a trace of a prior keeps the matrix regular.
    const double trace = square.trace() / static_cast<double>(n);
    square.diagonal().array() += 1e-12 * trace + 1e-300;
    const Eigen::MatrixXd inverse = square.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    // No sensor shows less: without it a log in which nothing moves would determine everything.
    const double error =
        std::max(now.squaredNorm(), static_cast<double>(now.size()) * kSensor * kSensor);
    std::vector<FittedServoParam> all;
    for (Eigen::Index i = 0; i < n; ++i) {
      const ServoParamInfo& info = infos_[static_cast<std::size_t>(i)];
      FittedServoParam one{&info, params.*info.at, 0, false};
      one.determined_within = info.scale * std::sqrt(0.06 * error * std::max(0.0, inverse(i, i)));
      const double range = info.high - info.low;
      if (!(one.determined_within < range))
        one.determined_within = std::numeric_limits<double>::infinity();
      one.determined = one.determined_within < (info.low < 0 ? 0.5 * range : 0.5 * one.value);
      all.push_back(one);
    }
    return all;
  }

 private:
  // By each parameter in units of its scale. One-sided where a bound is near.
  Eigen::MatrixXd jacobian(const ServoParams& params, const Eigen::VectorXd& now) const {
    Eigen::MatrixXd slopes(now.size(), static_cast<Eigen::Index>(infos_.size()));
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      const ServoParamInfo& info = infos_[i];
      const double size = 0.02 * info.scale;
      const double step = params.*info.at + size <= info.high ? size : -size;
      ServoParams moved = params;
      moved.*info.at += step;
      slopes.col(static_cast<Eigen::Index>(i)) =
          (residuals(model_, moved, logs_) - now) * (info.scale / step);
    }
    return slopes;
  }

  // Where a bound is met and the cost falls beyond it, that parameter stays.
  ServoParams stepped(const ServoParams& params, const Eigen::MatrixXd& square,
                      const Eigen::VectorXd& gradient, double damping) const {
    std::vector<Eigen::Index> open;
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      const double value = params.*infos_[i].at, falls = -gradient(static_cast<Eigen::Index>(i));
      if ((value <= infos_[i].low && falls < 0) || (value >= infos_[i].high && falls > 0)) continue;
      open.push_back(static_cast<Eigen::Index>(i));
    }
    Eigen::MatrixXd matrix = square(open, open);
    matrix.diagonal() += damping * (matrix.diagonal().array() + 1e-9 * square.trace()).matrix();
    const Eigen::VectorXd change = matrix.ldlt().solve(-gradient(open));
    ServoParams next = params;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const ServoParamInfo& info = infos_[static_cast<std::size_t>(open[k])];
      next.*info.at = std::clamp(
          params.*info.at + info.scale * change(static_cast<Eigen::Index>(k)), info.low, info.high);
    }
    return next;
  }

  int model_;
  std::span<const ServoParamInfo> infos_;
  const std::vector<ServoLog>& logs_;
  const std::function<bool()>& stopped_;
};

// Where the search for a model begins: motors of the field, or what was found for models within it.
std::vector<ServoParams> starts(int model, const std::vector<ServoFit>& before) {
  std::vector<ServoParams> all;
  if (before.empty()) {
    for (const double kt : {0.4, 1.2, 2.2}) {
      for (const double resistance : {2.5, 5.0}) {
        ServoParams one;
        one.kt = kt;
        one.resistance = resistance;
        one.armature = 0.012 * kt * kt;
        one.base = 0.04 * kt;
        one.viscous = 0.01 * kt;
        all.push_back(one);
      }
    }
  }
  for (const ServoFit& fit : before) {
    // M2 does not contain M3, nor M3 M2.
    if (model == 3 && fit.model == 2) continue;
    ServoParams one = fit.params;
    all.push_back(one);
    if (fit.model < 2 || fit.model == 3) {
      one.stribeck = 0.3 * one.base;
      one.base *= 0.7;
    }
    if (model >= 3 && fit.model < 3) one.load = one.load_stribeck = 0.05;
    if (model == 4 && fit.model == 3) one.load_stribeck = 0.5 * one.load;
    if (model >= 5 && fit.model < 5) {
      one.motor = one.external = std::max(0.02, one.load);
      one.motor_stribeck = one.external_stribeck = std::max(0.02, one.load_stribeck);
      all.push_back(one);
      one.motor = 2 * one.motor;
      one.external = 0.02;
    }
    if (model == 6) one.motor_quad = one.external_quad = 0.01;
    all.push_back(one);
  }
  return all;
}

}  // namespace

// With J the inertia of load and armature, in steps of kStep: friction takes at most friction_limit(), and no
// more than what stops the shaft: f = -sign(t) min(|t|, limit), t = J w / dt + motor + external (the paper's
// equation of motion; here after the change of speed by the torques, so that it cannot turn round).
Prediction predict(int model, const ServoParams& p, const ServoLog& log) {
  Prediction all;
  const std::size_t n = log.samples.size();
  all.position_rad.reserve(n);
  all.current_a.reserve(n);
  const double inertia = log.load_kgm2() + p.armature, weight = log.gravity_nm();
  const double gain = p.gain_ratio * log.gain_per_rad;
  double angle = log.samples[0].position_rad - p.offset, speed = 0, current = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const ServoSample& now = log.samples[i];
    const auto drive = [&] {
      const double duty = clamped(gain * (now.goal_rad - p.offset - angle), log.most_duty);
      return now.torque_on ? (now.volts * duty - p.kt * speed) / p.resistance : 0;
    };
    current = drive();
    all.position_rad.push_back(angle + p.offset);
    all.current_a.push_back(current);
    if (i + 1 == n) break;
    const double span = log.samples[i + 1].time_s - now.time_s;
    const int steps = std::max(1, static_cast<int>(std::lround(span / kStep)));
    const double dt = span / steps;
    for (int k = 0; k < steps; ++k) {
      const double motor = p.kt * drive(), external = -weight * std::sin(angle);
      const double limit = friction_limit(model, p, speed, motor, external);
      const double stop = inertia / dt * speed + motor + external;
      const double friction = -std::copysign(std::min(std::abs(stop), limit), stop);
      speed += (motor + external + friction) / inertia * dt;
      angle += speed * dt;
      if (!(std::abs(angle) < kAway)) {
        angle = std::copysign(kAway, angle);
        speed = 0;
      }
    }
  }
  return all;
}

LogErrors errors_of(int model, const ServoParams& params, const std::vector<ServoLog>& logs) {
  LogErrors errors;
  double samples = 0, current = 0, currents = 0;
  for (const ServoLog& log : logs) {
    const Prediction made = predict(model, params, log);
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
  std::vector<ServoFit> all;
  for (const int model : options.models) {
    const Fitter fitter(model, logs, options.stopped);
    std::vector<ServoParams> from = starts(model, all);
    // All a few rounds, then the best two to the end.
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (options.progress)
        options.progress((static_cast<double>(all.size()) +
                          0.6 * static_cast<double>(i) / static_cast<double>(from.size())) /
                             static_cast<double>(options.models.size()),
                         "model M" + std::to_string(model));
      order.emplace_back(fitter.improve(from[i], 6), i);
    }
    std::ranges::sort(order);
    ServoFit best;
    best.model = model;
    double cost = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < std::min<std::size_t>(2, order.size()); ++k) {
      ServoParams& params = from[order[k].second];
      const double now = fitter.improve(params, 40);
      if (!(now < cost)) continue;
      cost = now;
      best.params = params;
    }
    if (options.stopped()) return fail(Fault::interrupted, "interrupted; nothing was fitted");
    best.fit = errors_of(model, best.params, logs);
    if (!std::isfinite(cost) || best.fit.position_rad > 1)
      return fail(Fault::failed,
                  "no motor model fits these logs: check gain_per_rad and the weight, and check "
                  "that position_rad is 0 while the arm hangs down");
    best.held_out = errors_of(model, best.params, held_out);
    best.fitted = fitter.judged(best.params);
    all.push_back(std::move(best));
  }
  return all;
}

}  // namespace kaz::hil
