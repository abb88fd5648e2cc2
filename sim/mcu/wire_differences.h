// Where the native board differs from the emulated one by design: the one list.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace kaz::sim {

struct WireException {
  const char* what;    // on the wire
  const char* h8;      // what the emulated board does
  const char* native;  // what the native one does
  const char* reason;
  // A field of a reply that is not compared; type 0: something else, which the comparison avoids or
  // allows for.
  std::uint8_t type = 0;
  const char* field = nullptr;
};

std::span<const WireException> wire_differences();

// As a table in Markdown; docs/emulator.md has it.
std::string wire_differences_table();

// Sets the bytes of `body` (address, type, sequence number, fields) to 0 that are not compared. Returns
// whether there are any.
bool mask_wire_differences(std::span<std::uint8_t> body);

}  // namespace kaz::sim
