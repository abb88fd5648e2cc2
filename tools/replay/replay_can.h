// Repeats the requests of a CAN log on a board, and compares the answers with the log.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/run/backend_options.h"

namespace kaz::tools {

struct ReplayCanOptions {
  std::string file;        // candump log (can_log.h)
  BackendOptions backend;  // the simulator, or one board's port
  bool json = false;
};

// Returns whether `path` has the ending of candump's logs, ".log", and is no folder of a run.
bool names_can_log(const std::string& path);

// Prints the result. Returns false if an answer differs from the log. At a port, switches the motors of all
// boards that the log names off at the end, also after a signal. Fails (usage) if the log has no request, or
// if `backend.robot` names several boards or a servo bus.
Result<bool> replay_can(const ReplayCanOptions& options);

}  // namespace kaz::tools
