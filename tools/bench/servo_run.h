// `kaz bench servo`: fits motor and friction of a servo to logs of a pendulum.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/servo/servo_log.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServoFitArguments {
  std::vector<std::string> logs, held_out;  // paths of logs (servo_log.h) or of folders of logs
  int model = 0;                            // number of the largest model to fit; 0: all six models
  std::string out = "kaz-servo";
  bool json = false;
};

// Reads logs, and all logs (*.csv, *.json) of folders. Errors (usage) name the file.
Result<std::vector<hil::ServoLog>> read_servo_logs(const std::vector<std::string>& paths);

// Fits the models and prints a table. Writes report.html, result.json and plots of the first 40
// held-out logs.
Result<bool> run_servo_fit(const ServoFitArguments& arguments);

}  // namespace kaz::tools
