// Diagnostics of flashing: what failed, the values expected and received, likely causes, and the next step.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::host {

struct Diagnostic {
  std::string what;      // problem, such as "boot mode failed at H'55"
  std::string expected;  // such as "the byte H'00 as the reply to the byte H'00 at 9600 baud"
  std::string came;      // bytes or values received, such as "4b 80 00"
  std::vector<std::string> causes;  // most likely first
  std::string next;                 // next step, for example a command
};

// Returns an error whose message is `what`; the other members are its details. Line breaks within the members
// become spaces.
tl::unexpected<Error> fail(Fault fault, const Diagnostic& diagnostic);

// Returns up to 16 bytes as text, such as "4b 80 00"; "nothing" if `bytes` is empty.
std::string hex_of(const std::vector<std::uint8_t>& bytes);
// Returns a text such as "0x0011e0".
std::string hex_address(std::uint32_t address);
// Returns a text such as "6ef7".
std::string hex_word(std::uint16_t word);

}  // namespace kaz::host
