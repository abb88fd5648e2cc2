// Searches the parameters of the servo model that fit logs best.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hil/servo/fit_sums.h"
#include "hil/servo/servo_fit.h"

namespace kaz::hil {

class Fitter {
 public:
  // Each log's rig must be in `rigs`. `scales` is the size of FitPoint::scales. The logs and `stopped` must
  // outlive the object. `threads` is at least 1; it does not change the result.
  Fitter(int model, const std::vector<FitLog>& logs, const std::vector<std::string>& rigs,
         int threads, const std::function<bool()>& stopped, std::size_t scales = 0);

  double cost(const FitPoint& point) const { return logs_.cost(point); }
  const FitLogs& logs() const { return logs_; }

  // After this call, improve() changes zeros and scales only.
  void fix_params() { first_open_ = static_cast<Eigen::Index>(infos_.size()); }

  // Improves `point` by the Levenberg-Marquardt method within the bounds, until a round improves the cost by
  // less than the share `least`. Returns the cost.
  double improve(FitPoint& point, int rounds, double least) const;

  // Adds values and uncertainties of `point` to `fit`.
  void judge(const FitPoint& point, ServoFit& fit, std::span<const std::string> rigs) const;

 private:
  // One unknown of a fit: a parameter of the model, a rig's zero or a scale.
  struct Unknown {
    double low, high, scale;
  };

  double& value_of(FitPoint& point, std::size_t i) const;
  FitPoint stepped(const FitPoint& point, const FitSums& now, double damping) const;

  std::span<const ServoParamInfo> infos_;
  std::vector<Unknown> unknowns_;
  Eigen::Index first_open_ = 0;
  FitLogs logs_;
  const std::function<bool()>& stopped_;
};

// Returns logs without scales.
std::vector<FitLog> unscaled(const std::vector<const ServoLog*>& logs);

// Returns the rigs of the logs in order of appearance, without those in `known`.
std::vector<std::string> rigs_of(const std::vector<const ServoLog*>& logs,
                                 const std::vector<std::string>& known = {});

std::vector<const ServoLog*> pointers_to(const std::vector<ServoLog>& logs);

// Returns at most `most` logs: a random choice that is the same in every call. Files often come sorted by
// motion, and a regular choice would miss some motions.
std::vector<const ServoLog*> some_logs(std::vector<const ServoLog*> logs, std::size_t most);

// Returns the number of threads to use: `wanted`, or one for each core if `wanted` is 0.
int fit_threads(int wanted);

}  // namespace kaz::hil
