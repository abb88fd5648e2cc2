// Predicts the motion of a log's pendulum by the servo model.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/servo/servo_log.h"
#include "shared/servo_model/servo_model.h"

namespace kaz::hil {

using servo_model::ServoParamInfo;
using servo_model::ServoParams;

// Motion that the model predicts for the goals of a log, with one entry for each sample. The motion starts at
// the first reading of the log.
struct Prediction {
  std::vector<double> position_rad, current_a;
};

// `zero_rad` is the reading while the arm hangs straight down. `step_s` is the largest step of the model.
// With 4 ms, predictions of 80 STS3215 logs differ by 0.12 mrad (mean) from those with 0.25 ms.
Prediction predict(int model, const ServoParams& params, const ServoLog& log, double zero_rad = 0,
                   double step_s = 4e-3);

}  // namespace kaz::hil
