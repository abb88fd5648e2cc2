// Diagnostics of flashing: what failed, what was expected and received, likely causes, next step.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::host {

struct Diagnostic {
  std::string what;                 // "the board did not answer in boot mode"
  std::string expected;             // "H'00 in answer to H'00 at 9600 baud"
  std::string came;                 // what came instead: "nothing in 2.0 s"
  std::vector<std::string> causes;  // most likely first
  std::string next;                 // a command, or what to do
};

// Several lines without a final newline; text from outside breaks none of them.
std::string text_of(const Diagnostic& diagnostic);
tl::unexpected<Error> fail(Fault fault, const Diagnostic& diagnostic);

// "4b 80 00", up to 16 bytes; "nothing" if empty.
std::string hex_of(const std::vector<std::uint8_t>& bytes);
// "0x0011e0"
std::string hex_address(std::uint32_t address);
// "6ef7"
std::string hex_word(std::uint16_t word);

}  // namespace kaz::host
