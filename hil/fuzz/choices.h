// Reads decisions from a string of bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace kaz::hil::fuzz {

class Choices {
 public:
  explicit Choices(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  bool ended() const { return left_.empty(); }
  // Returns the next byte; 0 after the end of the string.
  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t value = left_.front();
    left_ = left_.subspan(1);
    return value;
  }
  std::uint32_t word() {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = value << 8 | byte();
    return value;
  }
  // Returns a number from 0 to bound - 1, read from one byte. `bound` is at most 256.
  unsigned below(unsigned bound) { return byte() % bound; }
  // Returns a number from low to high, read from as many bytes as the range requires.
  long long between(long long low, long long high) {
    const auto range = static_cast<unsigned long long>(high - low) + 1;
    unsigned long long value = 0;
    for (unsigned long long covered = 1; covered < range; covered <<= 8)
      value = value << 8 | byte();
    return low + static_cast<long long>(value % range);
  }

 private:
  std::span<const std::uint8_t> left_;
};

}  // namespace kaz::hil::fuzz
