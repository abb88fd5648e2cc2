// Finds logs whose header or time stamps contradict the other logs: gain, mass, length, inertia and time.
// SPDX-License-Identifier: Apache-2.0
//
// A factor that is common to all logs is not found, because parameters absorb it. `gain_ratio` absorbs a
// gain. Without measured currents, `resistance` absorbs a weight. Two groups that contradict each other do
// not show which one is wrong. Mass and length have nearly the same effect on one log.
#pragma once

#include <string>
#include <vector>

#include "hil/servo/servo_fit.h"

namespace kaz::hil {

// A stated value that fits the logs better when it is multiplied by `factor`.
struct WrongInput {
  std::string logs;      // such as "logs with gain 2.64 per rad", or the name of a log
  std::string quantity;  // "gain", "weight (mass or length)", "inertia" or "time stamps"
  double factor = 1;
  double sigma = 0;  // standard deviation of log(factor) between logs; 0: judged by one log's error
  std::string other;  // name of the other group if there are only two; either can be wrong
};

// Compares the logs in two steps. First, a factor of the gain is fitted for each stated gain, and factors of
// weight and inertia for each rig, together with all parameters. A factor is wrong if it differs from the
// median by more than 15 % and by more than 4 standard deviations. The deviations are those of the sandwich
// estimator, where each log is one block. Second, logs with an error far above their motion's median are
// predicted with other values. A value is wrong if it halves the log's error. `fit` must have zeros for all
// rigs. If `options.stopped` returns true, the check ends early, without findings.
std::vector<WrongInput> wrong_inputs(const ServoFit& fit, const std::vector<ServoLog>& logs,
                                     const ServoFitOptions& options = {});

std::string sentence_of(const WrongInput& one);

}  // namespace kaz::hil
