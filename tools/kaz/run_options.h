// The options of `kaz demo` and `kaz run`.
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
  std::string goal;                   // of navigate
  std::string poses;                  // file, of play
  std::string memory;                 // file
  WatchArguments watch;
};

// Of both verbs; what they describe differently is added by the others.
void add_run_options(CLI::App& verb, RunArguments& arguments);
CLI::Option* add_duration(CLI::App& verb, RunArguments& arguments, const std::string& text);
// --out DIR; `more`: the end of its sentence.
void add_out(CLI::App& verb, RunArguments& arguments, const std::string& more);
Result<bool> run_behavior(RunArguments arguments);

}  // namespace kaz::tools
