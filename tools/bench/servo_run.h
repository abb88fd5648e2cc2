// `kaz bench servo`: fits motor and friction of a servo to logs of a pendulum.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServoFitArguments {
  std::vector<std::string> logs, held_out;  // paths of logs (servo_log.h)
  int model = 0;                            // number of the largest model to fit; 0: all six models
  std::string out = "kaz-servo";
  bool json = false;
};

// Fits the models and prints a table. Writes report.html, result.json and a plot of each held-out log.
Result<bool> run_servo_fit(const ServoFitArguments& arguments);

}  // namespace kaz::tools
