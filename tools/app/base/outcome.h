// How a task of the command line ended.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"

namespace kaz::tools {

// The exit status: 0 done, 1 the task failed, or the status of the program that was run.
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
