// `kaz serve-port`: the port of a board for clients on other machines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServePortOptions {
  std::string port;                       // as parse_port_address() has it
  std::string listen = "127.0.0.1:7217";  // HOST:PORT
  bool raw = false;                       // bytes alone instead of RFC 2217
};

// Runs until SIGINT, SIGTERM or SIGHUP, which are its normal end.
Result<bool> serve_port(const ServePortOptions& options);

}  // namespace kaz::tools
