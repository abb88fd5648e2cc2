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
  std::string servo = "unknown";  // model as in bus.json, for servo.json
  std::string compare;            // servo file or name of a shipped servo; empty: no comparison
  std::string out = "kaz-servo";
  bool json = false;
};

// Reads logs, and all logs (*.csv, *.json) of folders. Errors (usage) name the file.
Result<std::vector<hil::ServoLog>> read_servo_logs(const std::vector<std::string>& paths);

// Fits the models and prints a table. Writes report.html, result.json, servo.json (servo_file.h) and plots of
// the first 40 held-out logs.
Result<bool> run_servo_fit(const ServoFitArguments& arguments);

}  // namespace kaz::tools
