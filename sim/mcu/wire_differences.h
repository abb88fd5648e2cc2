// Lists the intended differences between the native board and the emulated board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kaz::sim {

struct WireException {
  const char* what;    // the difference on the wire
  const char* h8;      // behavior of the emulated board
  const char* native;  // behavior of the native board
  const char* reason;
  // In replies of the message type `type`, the comparison leaves out the field with the name `field`. If
  // `type` is 0, the difference is not in a field of a reply. If `type` is 0, the comparison does one of
  // three things: accept the difference, avoid the cause of the difference, or end the conversation early.
  std::uint8_t type = 0;
  const char* field = nullptr;
};

std::span<const WireException> wire_differences();

// Writes 0 to each byte of `body` that the comparison leaves out. `body` consists of address, type, sequence
// number and fields. Returns true if the function has overwritten at least one byte.
bool mask_wire_differences(std::span<std::uint8_t> body);

}  // namespace kaz::sim
