// Result of a command-line task, as an exit status.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"

namespace kaz::tools {

// Exit status: 0 success, 1 the task failed, or the status of a program that the task ran.
struct Outcome {
  Outcome(bool succeeded = true) : status(succeeded ? 0 : static_cast<int>(Fault::failed)) {}
  static Outcome with_status(int status) {
    Outcome outcome(true);
    outcome.status = status;
    return outcome;
  }
  int status;
};

}  // namespace kaz::tools
