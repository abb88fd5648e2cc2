// The verbs of the command line. Each adds itself to the program and, when chosen, sets what to do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "shared/base/result.hpp"

namespace kaz::tools {

// How a verb ended: 0 done, 1 the task failed, or what a program that it ran says.
struct Outcome {
  Outcome(bool succeeded = true) : status(succeeded ? 0 : static_cast<int>(Fault::failed)) {}
  static Outcome with_status(int status) {
    Outcome outcome(true);
    outcome.status = status;
    return outcome;
  }
  int status;
};

// Runs after the whole command line was read. An Error has its own exit code
// (shared/base/result.hpp).
using Action = std::function<Result<Outcome>()>;

// A number above 0; CLI11's own check would print the largest one there is.
inline CLI::Validator positive() {
  return CLI::Validator(
      [](std::string& text) {
        double number = 0;
        const bool sound = CLI::detail::lexical_cast(text, number) && number > 0;
        return sound ? std::string() : "`" + text + "` is not a number above 0";
      },
      "POSITIVE");
}

void add_demo(CLI::App& program, Action& action);
void add_run(CLI::App& program, Action& action);
void add_sim(CLI::App& program, Action& action);
void add_evaluate(CLI::App& program, Action& action);
void add_eyes(CLI::App& program, Action& action);
void add_calibrate(CLI::App& program, Action& action);
void add_replay(CLI::App& program, Action& action);
void add_mcu(CLI::App& program, Action& action);
void add_conformance(CLI::App& program, Action& action);
void add_bench(CLI::App& program, Action& action);
void add_flash(CLI::App& program, Action& action);
void add_fuzz(CLI::App& program, Action& action);
void add_status(CLI::App& program, Action& action);
void add_monitor(CLI::App& program, Action& action);
void add_vision(CLI::App& program, Action& action);
void add_shell(CLI::App& program, Action& action);  // last: it tells of all others

}  // namespace kaz::tools
