// Sampling, ranking, and the updates of mean, variances and step size.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/balance/evolution.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shared/base/random.hpp"

namespace kaz::balance {

using Eigen::VectorXd;

Evolution::Evolution(VectorXd mean, double sigma, int population, std::uint64_t seed)
    : seed_(seed),
      weights_(population / 2),
      mean_(std::move(mean)),
      variance_(VectorXd::Ones(mean_.size())),
      path_(VectorXd::Zero(mean_.size())),
      step_path_(VectorXd::Zero(mean_.size())),
      normal_(mean_.size(), population),
      candidates_(mean_.size(), population),
      sigma_(sigma) {
  for (Eigen::Index i = 0; i < weights_.size(); ++i)
    weights_[i] = std::log(population / 2 + 0.5) - std::log(static_cast<double>(i) + 1);
  weights_ /= weights_.sum();
  draw();
}

void Evolution::draw() {
  const Eigen::Index size = normal_.rows(), population = normal_.cols();
  const VectorXd scale = sigma_ * variance_.cwiseSqrt();
  for (Eigen::Index k = 0; k < population; ++k) {
    const Eigen::Index pair = generation_ * population / 2 + k / 2;
    for (Eigen::Index i = 0; i < size; ++i)
      normal_(i, k) = (k % 2 == 0 ? 1 : -1) *
                      keyed_normal(seed_, static_cast<std::uint64_t>(pair * size + i), 1);
    candidates_.col(k) = mean_ + scale.cwiseProduct(normal_.col(k));
  }
}

void Evolution::advance(std::span<const double> scores) {
  const double n = static_cast<double>(mean_.size());
  // Parameters of the tutorial's table 1.
  const double mu_eff = 1 / weights_.squaredNorm();
  const double c_path = (4 + mu_eff / n) / (n + 4 + 2 * mu_eff / n);
  const double c_step = (mu_eff + 2) / (n + mu_eff + 5);
  const double separable = (n + 2) / 3;
  const double c_one = std::min(0.5, separable * 2 / ((n + 1.3) * (n + 1.3) + mu_eff));
  const double c_mu =
      std::min(1 - c_one, separable * 2 * (mu_eff - 2 + 1 / mu_eff) / ((n + 2) * (n + 2) + mu_eff));
  const double damping = 1 + 2 * std::max(0.0, std::sqrt((mu_eff - 1) / (n + 1)) - 1) + c_step;
  const double expected = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));

  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
  VectorXd better = VectorXd::Zero(mean_.size()), squares = better;
  for (Eigen::Index i = 0; i < weights_.size(); ++i) {
    const auto sample = normal_.col(static_cast<Eigen::Index>(order[static_cast<std::size_t>(i)]));
    better += weights_[i] * sample;
    squares += weights_[i] * variance_.cwiseProduct(sample.cwiseAbs2());
  }
  const VectorXd step = variance_.cwiseSqrt().cwiseProduct(better);
  mean_ += sigma_ * step;
  step_path_ = (1 - c_step) * step_path_ + std::sqrt(c_step * (2 - c_step) * mu_eff) * better;
  const double length = step_path_.norm();
  const double full = std::sqrt(1 - std::pow(1 - c_step, 2 * (generation_ + 1)));
  const bool stalled = length / full >= (1.4 + 2 / (n + 1)) * expected;
  path_ *= 1 - c_path;
  if (!stalled) path_ += std::sqrt(c_path * (2 - c_path) * mu_eff) * step;
  variance_ = (1 - c_one - c_mu) * variance_ + c_one * path_.cwiseAbs2() + c_mu * squares;
  sigma_ *= std::exp(c_step / damping * (length / expected - 1));
  ++generation_;
  draw();
}

nlohmann::json Evolution::state() const {
  const auto list = [](const VectorXd& v) { return std::vector<double>(v.begin(), v.end()); };
  return {{"generation", generation_},   {"sigma", sigma_},     {"mean", list(mean_)},
          {"variance", list(variance_)}, {"path", list(path_)}, {"step_path", list(step_path_)}};
}

Result<void> Evolution::resume(const nlohmann::json& state) {
  try {
    const auto take = [&](const char* name, VectorXd& to) {
      const auto values = state.at(name).get<std::vector<double>>();
      if (static_cast<Eigen::Index>(values.size()) != to.size()) return false;
      to = Eigen::Map<const VectorXd>(values.data(), to.size());
      return true;
    };
    if (!take("mean", mean_) || !take("variance", variance_) || !take("path", path_) ||
        !take("step_path", step_path_))
      return fail(Fault::usage, "it has another number of weights");
    sigma_ = state.at("sigma").get<double>();
    generation_ = state.at("generation").get<int>();
  } catch (const nlohmann::json::exception& wrong) {
    return fail(Fault::usage, wrong.what());
  }
  draw();
  return {};
}

}  // namespace kaz::balance
