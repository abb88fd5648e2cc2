// `kaz bench servo`: motor and friction of a servo from logs of a pendulum.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServoFitArguments {
  std::vector<std::string> logs, held_out;  // files (servo_log.h)
  int model = 0;                            // up to which; 0: all six
  std::string out = "kaz-servo";
  bool json = false;
};

// Fits, prints a table, and leaves report.html, result.json and a plot of each log held out.
Result<bool> run_servo_fit(const ServoFitArguments& arguments);

}  // namespace kaz::tools
