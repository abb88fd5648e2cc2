// `kaz sim`: virtual robot for other processes.
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
  bool boot = false;        // sets the mode pins to boot mode
  std::string calibration;  // file to write the cameras' calibration to; none if empty
};

// Fails (usage) if the folder of `path` is missing; the message names `option`. For links and sockets: their
// own errors come only after loading, and contain other paths.
Result<void> check_place(const std::string& option, const std::string& path);

// Runs until SIGINT, SIGTERM or SIGHUP, which end it normally. With only a calibration file to write, it
// returns at once.
Result<bool> serve(ServeOptions arguments);

}  // namespace kaz::tools
