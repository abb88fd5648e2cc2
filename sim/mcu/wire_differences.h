// Lists the differences by design between the native board and the emulated one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace kaz::sim {

struct WireException {
  const char* what;    // the difference on the wire
  const char* h8;      // behavior of the emulated board
  const char* native;  // behavior of the native board
  const char* reason;
  // Message type of a reply, and the field of it that the comparison leaves out. Type 0: another difference,
  // which the comparison avoids or allows for.
  std::uint8_t type = 0;
  const char* field = nullptr;
};

std::span<const WireException> wire_differences();

// Returns the list as a Markdown table, which docs/explanation/emulator.md contains.
std::string wire_differences_table();

// Sets the bytes of `body` (address, type, sequence number, fields) that are not compared to 0. Returns
// whether the body has such bytes.
bool mask_wire_differences(std::span<std::uint8_t> body);

}  // namespace kaz::sim
