// `kaz can-bridge`: a board's serial line on a CAN bus.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

struct CanBridgeOptions {
  std::string port;       // of the line, as parse_port_address() has it
  std::string interface;  // "can0"
  std::vector<std::uint8_t> addresses = {KZ_ADDRESS_DEFAULT};  // of the boards on the line
};

// Runs until SIGINT, SIGTERM or SIGHUP, which are its normal end.
Result<bool> bridge_can(const CanBridgeOptions& options);

}  // namespace kaz::tools
