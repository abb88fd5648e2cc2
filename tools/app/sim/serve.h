// `kaz sim`: a virtual robot for other processes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/runtime/serving/real_time.h"
#include "tools/app/session/backend.h"

namespace kaz::tools {

struct ServeOptions {
  BackendOptions backend;
  sim::RealTimeOptions real_time;
  std::string memory;       // file of the board's flash; none if empty
  bool boot = false;        // the mode pins select boot mode
  std::string calibration;  // file to write the cameras' calibration to; none if empty
};

// Runs until SIGINT, SIGTERM or SIGHUP, which are its normal end.
Result<bool> serve(ServeOptions arguments);

}  // namespace kaz::tools
