// The options of `kaz demo` and `kaz run`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/app/session/session.h"

namespace kaz::tools {

struct RunArguments {
  SessionOptions session;
  std::vector<std::string> settings;  // NAME=VALUE
  std::string duration;               // s
  std::string color;                  // file
};

void add_run_options(CLI::App& verb, RunArguments& arguments);
Result<bool> run_behavior(RunArguments arguments);

}  // namespace kaz::tools
