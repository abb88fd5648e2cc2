// `kaz bench`: measures a board and fits the motor model to the measurements.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"
#include "tools/app/bench/bench_target.h"
#include "tools/app/session/backend.h"

namespace kaz::tools {

struct BenchOptions {
  BenchTargetOptions target;
  bool motor = false, link = false, tick = false;  // what to measure
  std::string joints = "l_sh_pitch";               // names with commas between, or "all"
  std::string filter, limits;
  std::string out = "kaz-bench";  // the verb adds what is measured
  double supply_volts = 10;
  std::string of_motors;  // an option that was given and is of motors alone; empty: none
  bool allow_motion = false, json = false;
};

struct BenchFitOptions {
  std::string report, joint, out = "kaz-fit";
  BackendOptions model;
  bool json = false;
};

// Numbers of the joints in a list of names; each once.
Result<std::vector<int>> joints_of(const std::string& text);

// Writes the reports to `out`, prints each measurement. Status 1: one failed, or nothing was
// measured; 3: none failed, but this machine was too late to judge some.
Result<Outcome> run_bench(const BenchOptions& arguments);
// Fits the motor model to a report of run_bench().
Result<bool> run_fit(const BenchFitOptions& arguments);
void print_measurements(bool json);

}  // namespace kaz::tools
