// `kaz can-bridge`: connects a board's serial line to a CAN bus.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

struct CanBridgeOptions {
  std::string port;       // port of the serial line, as for parse_port_address()
  std::string interface;  // CAN interface, for example "can0"
  // Addresses of the boards on the line.
  std::vector<std::uint8_t> addresses = {KZ_ADDRESS_DEFAULT};
};

// Runs until SIGINT, SIGTERM or SIGHUP, which count as a normal end.
Result<bool> bridge_can(const CanBridgeOptions& options);

}  // namespace kaz::tools
