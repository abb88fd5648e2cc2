// Separable CMA-ES: an evolution strategy with its own step size for each parameter.
// SPDX-License-Identifier: Apache-2.0
//
// Source: Hansen 2016, "The CMA Evolution Strategy: A Tutorial" (arXiv 1604.00772). Only the diagonal of the
// covariance is used, with learning rates raised by (n + 2) / 3. Source: Ros and Hansen 2008, "A Simple
// Modification in CMA-ES Achieving Linear Time and Space Complexity". Samples come in pairs of opposite sign
// (mirrored sampling), which suits few samples of a noisy score. The same seed gives the same samples.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"

namespace kaz::balance {

class Evolution {
 public:
  // `sigma`: initial step size. `population`: even, at least 4.
  Evolution(Eigen::VectorXd mean, double sigma, int population, std::uint64_t seed);

  // Returns the candidates of this generation, one per column.
  const Eigen::MatrixXd& candidates() const { return candidates_; }
  // Begins the next generation. `scores`: one per candidate, in the same order; larger is better.
  void advance(std::span<const double> scores);

  const Eigen::VectorXd& mean() const { return mean_; }
  double sigma() const { return sigma_; }
  int generation() const { return generation_; }

  // Returns the complete state between generations.
  nlohmann::json state() const;
  // Restores a state. Returns Fault::usage if it belongs to another problem.
  Result<void> resume(const nlohmann::json& state);

 private:
  void draw();

  std::uint64_t seed_;
  Eigen::VectorXd weights_;  // weights of the better half
  Eigen::VectorXd mean_, variance_, path_, step_path_;
  Eigen::MatrixXd normal_, candidates_;
  double sigma_;
  int generation_ = 0;
};

}  // namespace kaz::balance
