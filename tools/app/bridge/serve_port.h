// `kaz serve-port`: serves the port of a board to clients on other machines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServePortOptions {
  std::string port;                       // for parse_port_address()
  std::string listen = "127.0.0.1:7217";  // HOST:PORT
  bool raw = false;                       // plain bytes instead of RFC 2217
};

// Runs until SIGINT, SIGTERM or SIGHUP, which end it normally.
Result<bool> serve_port(const ServePortOptions& options);

}  // namespace kaz::tools
