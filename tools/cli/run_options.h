// Options that `kaz demo` and `kaz run` share.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/cli/watch_options.h"
#include "tools/run/run_plan.h"

namespace kaz::tools {

struct RunArguments {
  RunOptions run;
  std::vector<std::string> settings;  // NAME=VALUE
  std::string duration;               // s
  std::string color;                  // path of a file
  std::string goal;                   // goal of navigate
  std::string poses;                  // path of a file, for play
  std::string memory;                 // path of a file
  WatchArguments watch;
};

// Adds the options that have the same description in both verbs. `arguments` must outlive `verb`.
void add_run_options(CLI::App& verb, RunArguments& arguments);
CLI::Option* add_duration(CLI::App& verb, RunArguments& arguments, const std::string& text);
// Adds --out DIR. `more`: text at the end of the option's description.
void add_out(CLI::App& verb, RunArguments& arguments, const std::string& more);
// Reads the files, checks the settings and runs the behavior. Returns the result of run(), or
// Fault::usage for invalid settings.
Result<bool> run_behavior(RunArguments arguments);

}  // namespace kaz::tools
