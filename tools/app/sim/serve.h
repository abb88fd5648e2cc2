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

// Checks that `path`, which the option names, can be made. For links and sockets, which their makers report
// by other paths, and only after loading.
Result<void> check_place(const std::string& option, const std::string& path);

// Runs until SIGINT, SIGTERM or SIGHUP, which are its normal end.
Result<bool> serve(ServeOptions arguments);

}  // namespace kaz::tools
