// Fits motor, friction and control law of a servo to logs of a pendulum.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "hil/servo/servo_log.h"
#include "hil/servo/servo_prediction.h"

namespace kaz::hil {

struct LogErrors {
  double position_rad = 0;  // mean of |predicted - measured|
  // Sum |predicted - measured| / sum |measured|; 0 if there are no currents.
  double current_share = 0;
};

struct FittedServoParam {
  const ServoParamInfo* of = nullptr;
  double value = 0;
  // Uncertainty of `value`. If the parameter is changed by the uncertainty, and then all other parameters are
  // fitted again, the fit's error becomes about 3 % larger. If the uncertainty is not smaller than the
  // parameter's range, `determined_within` is infinity.
  double determined_within = 0;
  // True if the uncertainty is less than half of `value`.
  bool determined = false;
};

// The horn is remounted for another weight, so each rig (ServoLog::rig()) has its own zero.
struct RigZero {
  std::string rig;
  double zero_rad = 0;  // reading while the arm hangs straight down
  // Uncertainty as above. If it is infinity, the logs do not determine the zero.
  double determined_within = 0;
  bool held_out = false;  // the rig has only held-out logs; see ServoFit::own_zeros
};

struct ServoFit {
  int model = 1;
  ServoParams params;
  std::vector<FittedServoParam> fitted;
  // A rig with only held-out logs has the mean zero of the fitted rigs.
  std::vector<RigZero> zeros;
  LogErrors fit, held_out;  // errors for the fitted logs and for the held-out logs
  // Mean position error for fitted logs that an inner split left out, rad. Infinity: there is no inner split.
  double inner_rad = std::numeric_limits<double>::infinity();
  // Zeros of rigs with only held-out logs, fitted to these logs and nothing else, and the error of all
  // held-out logs with these zeros. They describe the data, not a prediction.
  std::vector<RigZero> own_zeros;
  LogErrors held_out_own_zeros;

  // Zero of the log's rig; 0 if the fit had no log of the rig.
  double zero_of(const ServoLog& log) const;
  Prediction predict(const ServoLog& log) const {
    return hil::predict(model, params, log, zero_of(log));
  }
  // Copy of the fit in which rigs with only held-out logs have their own zeros.
  ServoFit with_own_zeros() const;
};

// Part of the fitted logs that is left out for the choice of a model.
struct InnerSplit {
  std::string name;  // such as "gain 2.64 per rad"
  std::vector<const ServoLog*> fitted, left_out;
};

// Inner splits for the choice of a model: the middle gain is left out, and the middle mass is left out (of
// two, the larger). A single gain or mass gives no split. Logs with one gain and one mass have one split: the
// last motion by name is left out. The splits do not depend on held-out logs.
std::vector<InnerSplit> inner_splits(const std::vector<ServoLog>& logs);

// Returns the simplest model whose `inner_rad` is within 3 % of the smallest; without inner splits, the
// same by the error of the fitted logs. `fits` must not be empty.
const ServoFit& chosen_fit(const std::vector<ServoFit>& fits);

// Computes the errors over all samples of all logs.
LogErrors errors_of(const ServoFit& fit, const std::vector<ServoLog>& logs);

struct ServoFitOptions {
  // Models to fit, in increasing order. Each fit starts from the results of simpler models.
  std::vector<int> models = {1, 2, 3, 4, 5, 6};
  int threads = 0;  // 0: one for each core. The result does not depend on the number of threads.
  std::function<void(double share, const std::string& what)> progress;
  // Called by several threads.
  std::function<bool()> stopped = [] { return false; };
};

// Fits each model. The fit minimizes the sum of sqrt(r^2 + (5 mrad)^2) over the residuals r. Some drops of a
// pendulum are bistable, and their large residuals would rule a sum of squares. Errors: there is no log
// (usage); no motor model fits the logs (failed); `stopped` returned true (interrupted).
Result<std::vector<ServoFit>> fit_servo(const std::vector<ServoLog>& logs,
                                        const std::vector<ServoLog>& held_out,
                                        const ServoFitOptions& options = {});

}  // namespace kaz::hil
