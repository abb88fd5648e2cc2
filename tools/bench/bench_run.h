// `kaz bench`: measures a board, and fits the motor model to the measurements.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/base/exit_status.h"
#include "tools/bench/bench_target.h"
#include "tools/run/backend.h"

namespace kaz::tools {

struct BenchOptions {
  BenchTargetOptions target;
  bool motor = false, link = false, tick = false;  // groups of measurements to make
  std::string joints = "l_sh_pitch";               // names of joints separated by commas, or "all"
  std::string filter, limits;
  // Output folder; `kaz bench` appends the group, for example "-motor".
  std::string out = "kaz-bench";
  double supply_volts = 10;
  // Name of a given option that is valid only for motors; empty: no such option was given.
  std::string of_motors;
  bool allow_motion = false, json = false;
};

struct BenchFitOptions {
  std::string report, joint, out = "kaz-fit";
  BackendOptions model;
  bool json = false;
};

// Parses a list of joint names. Returns the numbers of these joints, each number once.
Result<std::vector<int>> joints_of(const std::string& text);

// Writes the reports to the folder `out`, and prints each measurement. Exit status 1: a measurement failed,
// or no measurement passed. Exit status 3: no measurement failed, but some are undecided because a motor was
// warm, the line was disturbed, or this machine was late.
Result<ExitStatus> run_bench(const BenchOptions& arguments);
// Fits the motor model to a report of run_bench().
Result<bool> run_fit(const BenchFitOptions& arguments);
// Prints a list of all measurements with their limits.
void print_measurements(bool json);

}  // namespace kaz::tools
