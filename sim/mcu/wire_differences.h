// The list of differences by design between the native board and the emulated one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace kaz::sim {

struct WireException {
  const char* what;    // the difference on the wire
  const char* h8;      // behaviour of the emulated board
  const char* native;  // behaviour of the native board
  const char* reason;
  // A field of a reply that is not compared; type 0: something else, which the comparison avoids or
  // allows for.
  std::uint8_t type = 0;
  const char* field = nullptr;
};

std::span<const WireException> wire_differences();

// As a table in Markdown, which docs/explanation/emulator.md contains.
std::string wire_differences_table();

// Sets to 0 the bytes of `body` (address, type, sequence number, fields) that are not compared. Returns
// whether there are any.
bool mask_wire_differences(std::span<std::uint8_t> body);

}  // namespace kaz::sim
