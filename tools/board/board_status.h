// `kaz status`: reads the state of a board, without moving a joint or changing a setting.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

struct StatusOptions {
  std::string port;  // port of the board, as for parse_port()
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  bool json = false;
};

// Prints the state. Returns false if the board has latched a shutdown.
Result<bool> print_status(const StatusOptions& arguments);

}  // namespace kaz::tools
