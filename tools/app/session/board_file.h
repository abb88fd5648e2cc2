// Which joint is on which board: the file of `--robot boards:FILE`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/port_address.h"
#include "shared/base/result.hpp"
#include "shared/servo_bus/registers.h"

namespace kaz::tools {

struct BoardOfFile {
  host::PortAddress port;
  std::uint8_t address = 1;
  std::uint32_t joints = 0;  // mask
  std::optional<servo_bus::Protocol>
      bus;  // what is at the port is a bus of servos, and not a board
};

// {"boards": [{"port": "can:can0", "address": 2, "joints": ["neck_pan", ...]}, ...]}
// The address is 1 if it is not given. Each joint is on exactly one board; a serial line or a network
// port has one board, a CAN bus any number with addresses of their own. Errors (usage): what is wrong, in
// which board of `name`, and what to do.
Result<std::vector<BoardOfFile>> parse_boards(const std::string& name, std::string_view text);
Result<std::vector<BoardOfFile>> read_boards(const std::string& path);

}  // namespace kaz::tools
