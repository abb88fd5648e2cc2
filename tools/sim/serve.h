// `kaz sim`: simulates a robot that other processes can use.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/runtime/serving/real_time.h"
#include "tools/run/backend.h"

namespace kaz::tools {

struct ServeOptions {
  BackendOptions backend;
  sim::RealTimeOptions real_time;
  std::string memory;       // file that stores the board's flash; empty: no file
  bool boot = false;        // sets the mode pins to boot mode
  std::string calibration;  // file to which the cameras' calibration is written; empty: no file
};

// Fails (usage) if the folder of `path` is missing; the message names `option`. Check the paths of links and
// sockets with this function before the world is loaded. Creating a link or socket fails later, with an error
// that contains another path.
Result<void> check_place(const std::string& option, const std::string& path);

// Runs until SIGINT, SIGTERM or SIGHUP, which count as a normal end. If the only task is to write a
// calibration file, returns immediately.
Result<bool> serve(ServeOptions arguments);

}  // namespace kaz::tools
