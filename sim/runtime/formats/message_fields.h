// Reads the fields of ROS messages: ROS 1 (little-endian, no padding) and CDR (ROS 2).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kaz::sim {

// Reads fields from the front of a message. After a read beyond the end, good() is false, and all reads
// return zero or an empty value. CDR: the first 4 bytes state the byte order (XCDR 1, plain), and numbers are
// aligned to their size, counted from byte 4. Another encapsulation makes good() false.
class MessageFields {
 public:
  enum class Wire : std::uint8_t { ros1, cdr };
  using Bytes = std::span<const std::uint8_t>;

  // The message must outlive the object.
  MessageFields(Wire wire, Bytes message) : wire_(wire), bytes_(message) {
    if (wire == Wire::ros1) return;
    const Bytes head = take(4);
    good_ = good_ && head[0] == 0 && head[1] <= 1;
    big_endian_ = good_ && head[1] == 0;
    begin_ = at_;
  }

  template <std::unsigned_integral T>
  T number() {
    if (wire_ == Wire::cdr) take((sizeof(T) - (at_ - begin_) % sizeof(T)) % sizeof(T));
    const Bytes front = take(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < front.size(); ++i)
      value |= std::uint64_t{front[big_endian_ ? sizeof(T) - 1 - i : i]} << (8 * i);
    return static_cast<T>(value);
  }
  double real() { return std::bit_cast<double>(number<std::uint64_t>()); }
  // Returns `count` numbers; fewer if the message ends.
  std::vector<double> reals(std::size_t count) {
    std::vector<double> values;
    for (; values.size() < count && good_;) values.push_back(real());
    return values;
  }
  // Returns bytes after their number in 4 bytes.
  Bytes array() { return take(number<std::uint32_t>()); }
  std::string text() {
    const Bytes chars = array();
    std::string value(chars.begin(), chars.end());
    if (wire_ == Wire::cdr && value.ends_with('\0')) value.pop_back();
    return value;
  }
  bool good() const { return good_; }

 private:
  Bytes take(std::size_t size) {
    good_ = good_ && size <= bytes_.size() - at_;
    if (!good_) return {};
    at_ += size;
    return bytes_.subspan(at_ - size, size);
  }

  Wire wire_;
  Bytes bytes_;
  std::size_t at_ = 0, begin_ = 0;
  bool good_ = true, big_endian_ = false;
};

}  // namespace kaz::sim
