// `kaz serve-port`: serves the port of a board to clients on other machines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServePortOptions {
  std::string port;                       // port of the board, as for parse_port_address()
  std::string listen = "127.0.0.1:7217";  // HOST:PORT at which clients connect
  bool raw = false;                       // sends and receives plain bytes instead of RFC 2217
};

// Runs until SIGINT, SIGTERM or SIGHUP, which count as a normal end.
Result<bool> serve_port(const ServePortOptions& options);

}  // namespace kaz::tools
