// Reads the fields of a protobuf message one after the other (wire format of proto3, without groups).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kaz::sim {

class ProtobufFields {
 public:
  using Bytes = std::span<const std::uint8_t>;
  struct Field {
    std::uint64_t number = 0;  // number in the schema
    std::uint64_t value = 0;   // value of a varint, fixed32 or fixed64; for bytes, their count
    Bytes bytes;               // content of a string, bytes, message or packed list
  };

  // The message must outlive the object and the fields.
  explicit ProtobufFields(Bytes message) : left_(message) {}

  // Returns nullopt at the end, or if the message is malformed. good() distinguishes the two.
  std::optional<Field> next() {
    if (left_.empty() || !good_) return std::nullopt;
    const std::uint64_t tag = varint();
    Field field{tag >> 3, 0, {}};
    switch (tag & 7) {
      case 0:
        field.value = varint();
        break;
      case 1:
        field.value = fixed(8);
        break;
      case 2:
        field.value = varint();
        field.bytes = take(field.value);
        break;
      case 5:
        field.value = fixed(4);
        break;
      default:
        good_ = false;
    }
    return good_ ? std::optional(field) : std::nullopt;
  }
  bool good() const { return good_; }

 private:
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 70; shift += 7) {
      const Bytes byte = take(1);
      if (byte.empty()) return 0;
      if (shift < 64) value |= std::uint64_t{byte[0] & 0x7FU} << shift;
      if (byte[0] < 0x80) return value;
    }
    good_ = false;
    return 0;
  }
  std::uint64_t fixed(std::size_t size) {
    std::uint64_t value = 0;
    const Bytes bytes = take(size);
    for (std::size_t k = 0; k < bytes.size(); ++k) value |= std::uint64_t{bytes[k]} << (8 * k);
    return value;
  }
  Bytes take(std::uint64_t size) {
    good_ = good_ && size <= left_.size();
    if (!good_) return {};
    const Bytes front = left_.first(static_cast<std::size_t>(size));
    left_ = left_.subspan(front.size());
    return front;
  }

  Bytes left_;
  bool good_ = true;
};

// Appends the numbers of a repeated double: one field that is packed, or one field for each number.
inline void add_protobuf_doubles(const ProtobufFields::Field& field, std::vector<double>& numbers) {
  if (field.bytes.empty()) {
    numbers.push_back(std::bit_cast<double>(field.value));
    return;
  }
  for (std::size_t at = 0; at + 8 <= field.bytes.size(); at += 8) {
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < 8; ++k) bits |= std::uint64_t{field.bytes[at + k]} << (8 * k);
    numbers.push_back(std::bit_cast<double>(bits));
  }
}

}  // namespace kaz::sim
