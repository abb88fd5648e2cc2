// The verbs of the command line. Each adds itself to the program and, when chosen, sets what to do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Runs after the whole command line was read. Returns whether the task succeeded; an Error has its
// own exit code (shared/base/result.hpp).
using Action = std::function<Result<bool>()>;

void add_demo(CLI::App& program, Action& action);
void add_run(CLI::App& program, Action& action);
void add_sim(CLI::App& program, Action& action);
void add_mcu(CLI::App& program, Action& action);

}  // namespace kaz::tools
