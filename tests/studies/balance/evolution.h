// Separable CMA-ES: an evolution strategy with a step size of its own for each number.
// SPDX-License-Identifier: Apache-2.0
//
// Hansen 2016, "The CMA Evolution Strategy: A Tutorial" (arXiv 1604.00772), with the covariance's
// diagonal alone and its learning rates raised by (n + 2) / 3: Ros and Hansen 2008, "A Simple
// Modification in CMA-ES Achieving Linear Time and Space Complexity". Samples come in pairs of
// opposite sign (mirrored sampling), which suits few samples of a noisy measure. The same seed
// gives the same samples; larger scores are better.
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
  // `sigma`: initial step. `population`: even, at least 4.
  Evolution(Eigen::VectorXd mean, double sigma, int population, std::uint64_t seed);

  // This generation's candidates, one a column.
  const Eigen::MatrixXd& candidates() const { return candidates_; }
  // Their scores, in the same order; begins the next generation.
  void advance(std::span<const double> scores);

  const Eigen::VectorXd& mean() const { return mean_; }
  double sigma() const { return sigma_; }
  int generation() const { return generation_; }

  // All that goes from generation to generation.
  nlohmann::json state() const;
  // Goes on from there. Errors (usage): it is of another problem.
  Result<void> resume(const nlohmann::json& state);

 private:
  void draw();

  std::uint64_t seed_;
  Eigen::VectorXd weights_;  // of the better half
  Eigen::VectorXd mean_, variance_, path_, step_path_;
  Eigen::MatrixXd normal_, candidates_;
  double sigma_;
  int generation_ = 0;
};

}  // namespace kaz::balance
