// Writes and reads little-endian byte buffers, for MCAP and the ROS 1 message encoding.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kaz::sim {

// Appends values to a buffer.
class LittleEndian {
 public:
  // `to` must outlive this object.
  explicit LittleEndian(std::vector<std::uint8_t>& to) : to_(to) {}

  LittleEndian& number(std::unsigned_integral auto value) {
    for (std::size_t i = 0; i < sizeof(value); ++i)
      to_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  LittleEndian& real(double value) { return number(std::bit_cast<std::uint64_t>(value)); }
  LittleEndian& reals(std::span<const double> values) {
    const std::size_t begin = to_.size();
    to_.resize(begin + 8 * values.size());
    std::uint8_t* to = to_.data() + begin;
    for (const double value : values) {
      const auto bits = std::bit_cast<std::uint64_t>(value);
      for (int i = 0; i < 8; ++i) *to++ = static_cast<std::uint8_t>(bits >> (8 * i));
    }
    return *this;
  }
  LittleEndian& bytes(std::span<const std::uint8_t> values) {
    to_.insert(to_.end(), values.begin(), values.end());
    return *this;
  }
  // Writes the length in 4 bytes, then the characters.
  LittleEndian& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    to_.insert(to_.end(), value.begin(), value.end());
    return *this;
  }

 private:
  std::vector<std::uint8_t>& to_;
};

// Reads fields from the front of a buffer. If a field extends beyond the end of the buffer, the read of this
// field and all later reads fail. A failed read returns zero or an empty value. After a failed read, `rest()`
// no longer changes. A loop over `rest()` must therefore also check `good()`.
class LittleEndianFields {
 public:
  using Bytes = std::span<const std::uint8_t>;
  explicit LittleEndianFields(Bytes bytes) : bytes_(bytes) {}
  template <std::unsigned_integral T>
  T number() {
    T value = 0;
    const Bytes front = take(sizeof value);
    for (std::size_t i = 0; i < front.size(); ++i)
      value = static_cast<T>(value | static_cast<T>(T{front[i]} << (8 * i)));
    return value;
  }
  // Reads a length in 4 bytes, then that number of bytes.
  Bytes array() { return take(number<std::uint32_t>()); }
  std::string text() {
    const Bytes chars = array();
    return {chars.begin(), chars.end()};
  }
  Bytes take(std::size_t size) {
    good_ = good_ && size <= bytes_.size();
    if (!good_) return {};
    const Bytes front = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return front;
  }
  Bytes rest() const { return bytes_; }
  // Returns whether all fields so far were within the buffer.
  bool good() const { return good_; }
  // Returns whether all fields were within the buffer and no bytes are left.
  bool whole() const { return good_ && bytes_.empty(); }

 private:
  Bytes bytes_;
  bool good_ = true;
};

}  // namespace kaz::sim
