// Fits motor and friction of a servo to logs of a pendulum, and predicts other logs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/servo/friction_model.h"
#include "hil/servo/servo_log.h"

namespace kaz::hil {

// Motion that the model predicts for the goals of a log, with one entry for each sample. The motion starts at
// the first reading of the log.
struct Prediction {
  std::vector<double> position_rad, current_a;
};
Prediction predict(int model, const ServoParams& params, const ServoLog& log);

struct LogErrors {
  double position_rad = 0;  // mean of |predicted - measured|
  // Sum |predicted - measured| / sum |measured|; 0 if there are no currents.
  double current_share = 0;
};
// Computes the errors over all samples of all logs.
LogErrors errors_of(int model, const ServoParams& params, const std::vector<ServoLog>& logs);

struct FittedServoParam {
  const ServoParamInfo* of = nullptr;
  double value = 0;
  // Uncertainty of `value`. If the parameter is changed by the uncertainty, and then all other parameters are
  // fitted again, the squared error becomes about 6 % larger. If the uncertainty is not smaller than the
  // parameter's range, `determined_within` is infinity.
  double determined_within = 0;
  // True if the uncertainty is less than half of `value`. For a parameter that can be negative, true if the
  // uncertainty is less than half of the parameter's range.
  bool determined = false;
};

struct ServoFit {
  int model = 1;
  ServoParams params;
  std::vector<FittedServoParam> fitted;
  LogErrors fit, held_out;  // errors for the fitted logs and for the held-out logs
};

struct ServoFitOptions {
  // Models to fit, in increasing order. Each fit starts from the results of simpler models.
  std::vector<int> models = {1, 2, 3, 4, 5, 6};
  std::function<void(double share, const std::string& what)> progress;
  std::function<bool()> stopped = [] { return false; };
};

// Fits each model. Errors: there is no log (usage); no motor model fits the logs (failed); `stopped` returned
// true (interrupted).
Result<std::vector<ServoFit>> fit_servo(const std::vector<ServoLog>& logs,
                                        const std::vector<ServoLog>& held_out,
                                        const ServoFitOptions& options = {});

}  // namespace kaz::hil
