// `kaz status`: reads the state of a board. It moves and changes nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::tools {

struct StatusOptions {
  std::string port;  // for parse_port()
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  bool json = false;
};

// Prints the state. Returns false if a shutdown is latched.
Result<bool> print_status(const StatusOptions& arguments);

}  // namespace kaz::tools
