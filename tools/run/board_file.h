// Reads the file of `--robot boards:FILE`, which assigns joints to boards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/port_address.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

struct BoardOfFile {
  host::PortAddress port;
  std::uint8_t address = 1;
  std::uint32_t joints = 0;  // bit mask of joints
};

// Format: {"boards": [{"port": "can:can0", "address": 2, "joints": ["neck_pan", ...]}, ...]} The default
// address is 1. Each joint must be on exactly one board. A serial line or network port has one board. A CAN
// bus may have several boards, which must have different addresses. Error messages (usage) contain `name`,
// the board's number and advice.
Result<std::vector<BoardOfFile>> parse_boards(const std::string& name, std::string_view text);
Result<std::vector<BoardOfFile>> read_boards(const std::string& path);

}  // namespace kaz::tools
