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

// Quantity of a log that may be stated wrong.
enum class Stated { gain, weight, inertia, time };

// Multiplies the quantity of `log` by `factor` (above 0). Time is stretched around the first sample.
void scale_stated(ServoLog& log, Stated quantity, double factor);

// One quantity of a log, multiplied by the factor exp(FitPoint::scales[at]).
struct ScaledBy {
  Stated quantity = Stated::gain;
  std::size_t at = 0;
};

struct FitLog {
  const ServoLog* log = nullptr;
  std::vector<ScaledBy> scaled = {};
};

// A point of the search: parameters, one zero for each rig, and logarithms of factors of stated quantities.
struct FitPoint {
  ServoParams params;
  std::vector<double> zeros, scales = {};
};

// Cost, and its normal equations. The unknowns are the model's parameters in units of their scale, then the
// zeros in units of kZeroScale, then the scales in units of kLogScale. The Hessian is that of iteratively
// reweighted least squares.
struct FitSums {
  double cost = 0;
  Eigen::MatrixXd square;
  Eigen::VectorXd gradient;
};

inline constexpr double kZeroScale = 0.01, kMostZero = 0.2;  // rad
inline constexpr double kLogScale = 0.1, kMostLogScale = 1;

class FitLogs {
 public:
  // `logs` must outlive the object. `threads` is at least 1. `stopped` ends a sum early; the sum is then
  // meaningless.
  FitLogs(int model, const std::vector<FitLog>& logs, const std::vector<std::string>& rigs,
          int threads, const std::function<bool()>& stopped);

  double cost(const FitPoint& point) const;
  FitSums sums(const FitPoint& point) const;
  // The parts of sums() from each log, with the unknowns of sums().
  std::vector<FitSums> parts(const FitPoint& point) const;

 private:
  struct Entry {
    FitLog fit;
    std::size_t rig;
    double current_weight;  // rad/A; 0 if there are no currents
  };
  Eigen::VectorXd residuals(const Entry& entry, const FitPoint& point) const;
  FitSums part_of(const Entry& entry, const FitPoint& point) const;
  // Calls `work` for each index, by several threads.
  void for_each(const std::function<void(std::size_t)>& work) const;

  int model_;
  std::span<const ServoParamInfo> infos_;
  std::vector<Entry> entries_;
  int threads_;
  const std::function<bool()>& stopped_;
};

}  // namespace kaz::hil
