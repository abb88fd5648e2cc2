// Fits motor, friction and control law of a servo to logs of a pendulum.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
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
  bool held_out =
      false;  // the rig has only held-out logs; its zero was fitted to them, and nothing else
};

struct ServoFit {
  int model = 1;
  ServoParams params;
  std::vector<FittedServoParam> fitted;
  std::vector<RigZero> zeros;
  LogErrors fit, held_out;  // errors for the fitted logs and for the held-out logs

  // Zero of the log's rig; 0 if the fit had no log of the rig.
  double zero_of(const ServoLog& log) const;
  Prediction predict(const ServoLog& log) const {
    return hil::predict(model, params, log, zero_of(log));
  }
};

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
