// Little-endian bytes appended to a buffer: as MCAP and the ROS 1 message encoding have them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace kaz::sim {

class LittleEndian {
 public:
  explicit LittleEndian(std::vector<std::uint8_t>& to) : to_(to) {}

  LittleEndian& number(std::unsigned_integral auto value) {
    for (std::size_t i = 0; i < sizeof(value); ++i)
      to_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  LittleEndian& real(double value) { return number(std::bit_cast<std::uint64_t>(value)); }
  LittleEndian& bytes(std::span<const std::uint8_t> values) {
    to_.insert(to_.end(), values.begin(), values.end());
    return *this;
  }
  // Length in 4 bytes, then the characters.
  LittleEndian& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    to_.insert(to_.end(), value.begin(), value.end());
    return *this;
  }

 private:
  std::vector<std::uint8_t>& to_;
};

}  // namespace kaz::sim
