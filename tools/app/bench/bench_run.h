// `kaz bench`: measures a board, and fits the motor model to the measurements.
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
  bool motor = false, link = false, tick = false;  // groups to measure
  std::string joints = "l_sh_pitch";               // names separated by commas, or "all"
  std::string filter, limits;
  std::string out = "kaz-bench";  // `kaz bench` appends the group, as "-motor"
  double supply_volts = 10;
  std::string of_motors;  // name of a given option that applies only to motors; empty: none
  bool allow_motion = false, json = false;
};

struct BenchFitOptions {
  std::string report, joint, out = "kaz-fit";
  BackendOptions model;
  bool json = false;
};

// Parses a list of joint names. Returns their numbers, each once.
Result<std::vector<int>> joints_of(const std::string& text);

// Writes the reports to `out`, and prints each measurement. Status 1: a measurement failed, or none passed.
// Status 3: none failed, but some are undecided because of a warm motor, a disturbed line, or a late machine.
Result<Outcome> run_bench(const BenchOptions& arguments);
// Fits the motor model to a report of run_bench().
Result<bool> run_fit(const BenchFitOptions& arguments);
// Prints a list of all measurements with their limits.
void print_measurements(bool json);

}  // namespace kaz::tools
