// Formats bytes as hexadecimal digits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace kaz {

// Returns lower-case digits such as "4f4b0d", or "4f 4b 0d" if `between` is a space.
inline std::string hex_text(std::span<const std::uint8_t> bytes, std::string_view between = "") {
  static constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    if (!text.empty()) text += between;
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

}  // namespace kaz
