// Result of a command-line task, as an exit status.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"

namespace kaz::tools {

// Exit status: 0 success, 1 the task failed, or the status of a program that the task ran.
struct ExitStatus {
  ExitStatus(bool succeeded = true) : status(succeeded ? 0 : static_cast<int>(Fault::failed)) {}
  static ExitStatus with_status(int status) {
    ExitStatus made;
    made.status = status;
    return made;
  }
  int status;
};

}  // namespace kaz::tools
