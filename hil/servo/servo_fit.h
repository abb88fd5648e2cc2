// Fits motor and friction of a servo to logs of a pendulum, and predicts logs that it has not seen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/servo/friction_model.h"
#include "hil/servo/servo_log.h"

namespace kaz::hil {

// What the model does with a log's goals, from its first reading on; one entry for each sample.
struct Prediction {
  std::vector<double> position_rad, current_a;
};
Prediction predict(int model, const ServoParams& params, const ServoLog& log);

struct LogErrors {
  double position_rad = 0;   // mean of |predicted - read|
  double current_share = 0;  // sum of |predicted - read| over sum of |read|; 0 without currents
};
// Over all samples of all logs.
LogErrors errors_of(int model, const ServoParams& params, const std::vector<ServoLog>& logs);

struct FittedServoParam {
  const ServoParamInfo* of = nullptr;
  double value = 0;
  // The squared error grows by 6 % (the mean error by 3 %) where the parameter is this far away and all
  // others follow it; infinite where the logs say nothing of it.
  double determined_within = 0;
  bool determined =
      false;  // that is less than half of the value, or of its range where it may be negative
};

struct ServoFit {
  int model = 1;
  ServoParams params;
  std::vector<FittedServoParam> fitted;
  LogErrors fit, held_out;  // of the logs that were fitted, and of those that were not
};

struct ServoFitOptions {
  std::vector<int> models = {1, 2, 3, 4, 5, 6};  // growing; each begins at those before
  std::function<void(double share, const std::string& what)> progress;
  std::function<bool()> stopped = [] { return false; };
};

// Errors: usage, no log; failed, no start leads to a motor that follows; interrupted.
Result<std::vector<ServoFit>> fit_servo(const std::vector<ServoLog>& logs,
                                        const std::vector<ServoLog>& held_out,
                                        const ServoFitOptions& options = {});

}  // namespace kaz::hil
