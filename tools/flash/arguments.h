// Options of `kaz flash`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/flash/flash_image.h"
#include "shared/protocol/messages.h"

namespace kaz::tools {

struct FlashArguments {
  std::string verb, image, port, reset, writer, out;
  h8s::LoadOptions load;
  std::uint32_t from = 0, length = host::kFlashBytes;
  std::vector<int> blocks;
  int boot_baud = 9600;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // address of the board on its line
  bool dry_run = false, force = false, start = true, json = false;
};

// Fails if an option is missing, or if options exclude each other. Needs no board.
Result<void> check(const FlashArguments& arguments);

}  // namespace kaz::tools
