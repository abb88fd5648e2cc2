// Options that `kaz demo` and `kaz run` share.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/app/session/session.h"
#include "tools/kaz/watch_options.h"

namespace kaz::tools {

struct RunArguments {
  SessionOptions session;
  std::vector<std::string> settings;  // NAME=VALUE
  std::string duration;               // s
  std::string color;                  // file
  std::string goal;                   // for navigate
  std::string poses;                  // file, for play
  std::string memory;                 // file
  WatchArguments watch;
};

// Adds the options that both verbs describe in the same way. `arguments` must outlive `verb`.
void add_run_options(CLI::App& verb, RunArguments& arguments);
CLI::Option* add_duration(CLI::App& verb, RunArguments& arguments, const std::string& text);
// Adds --out DIR. `more`: end of its description.
void add_out(CLI::App& verb, RunArguments& arguments, const std::string& more);
// Reads the files, checks the settings and runs the behavior. Returns as run_session(); wrong settings are
// Fault::usage.
Result<bool> run_behavior(RunArguments arguments);

}  // namespace kaz::tools
