// Residuals of the servo model over many logs, summed up for a fit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "hil/servo/servo_prediction.h"

namespace kaz::hil {

// A point of the search: parameters, and one zero for each rig.
struct FitPoint {
  ServoParams params;
  std::vector<double> zeros;
};

// Cost, and its normal equations. The unknowns are the model's parameters in units of their scale, then the
// zeros in units of kZeroScale. The Hessian is that of iteratively reweighted least squares.
struct FitSums {
  double cost = 0;
  Eigen::MatrixXd square;
  Eigen::VectorXd gradient;
};

inline constexpr double kZeroScale = 0.01, kMostZero = 0.2;  // rad

class FitLogs {
 public:
  // `logs` must outlive the object. `threads` is at least 1. `stopped` ends a sum early; the sum is then
  // meaningless.
  FitLogs(int model, std::vector<const ServoLog*> logs, const std::vector<std::string>& rigs,
          int threads, const std::function<bool()>& stopped);

  double cost(const FitPoint& point) const;
  FitSums sums(const FitPoint& point) const;
  int model() const { return model_; }

 private:
  struct Entry {
    const ServoLog* log;
    std::size_t rig;
    double current_weight;  // rad/A; 0 if there are no currents
  };
  Eigen::VectorXd residuals(const Entry& entry, const FitPoint& point) const;
  FitSums sums_of(const Entry& entry, const FitPoint& point) const;
  // Calls `work` for each index, by several threads.
  void for_each(const std::function<void(std::size_t)>& work) const;

  int model_;
  std::span<const ServoParamInfo> infos_;
  std::vector<Entry> entries_;
  int threads_;
  const std::function<bool()>& stopped_;
};

}  // namespace kaz::hil
