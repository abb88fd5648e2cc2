// The protocol's message table as data for the test cases: bounds of request fields, and reply fields by
// name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/conformance/codec.h"
#include "shared/protocol/messages.h"

namespace kaz::hil {

struct Field {
  std::string name;
  int size = 0;  // bytes per number
  bool is_signed = false;
  // How many numbers the field contains. If `masked` is true, the field contains at most `count` numbers.
  int count = 1;
  bool masked = false;
  bool bounded = false;
  long low = 0, high = 0;

  long lowest() const { return is_signed ? -(1L << (8 * size - 1)) : 0; }
  long highest() const { return (1L << (is_signed ? 8 * size - 1 : 8 * size)) - 1; }
};

struct Message {
  std::string name;
  std::uint8_t code = 0;
  kz_kind kind = KZ_KIND_NONE;
  std::vector<Field> fields;
  bool is_request() const { return code < 0x80; }
};

const std::vector<Message>& messages();
// Returns a message of messages.def. Throws std::logic_error for an unknown name.
const Message& message(std::string_view name);

// Builds the fields of a request, one number after the other, big-endian.
class Put {
 public:
  Put& u8(long value) { return number(value, 1); }
  Put& u16(long value) { return number(value, 2); }
  Put& s16(long value) { return number(value, 2); }
  Put& u32(long value) { return number(value, 4); }
  Put& number(long value, int size);
  operator Bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

// Returns the fields of a request. In the field with the index `changed`, every number is `value`. In the
// other fields, every number is legal: the lowest legal value if the field is bounded, otherwise 0.
Bytes legal_fields(const Message& request, int changed = -1, long value = 0);

// Fields of a reply by their names in the table. The constructor throws Failed if the length is wrong.
class Reply {
 public:
  Reply(const Message& message, const Frame& frame);
  long operator[](std::string_view field) const { return number(field, 0); }
  // Returns one number of a field. For a masked field, `index` is the joint. Throws Failed if the number does
  // not exist.
  long number(std::string_view field, int index) const;
  const Frame& frame() const { return frame_; }
  int reason() const { return static_cast<int>((*this)["status"] >> 8); }  // KZ_SHUTDOWN_*
  bool flag(long status_flag) const { return ((*this)["status"] & status_flag) != 0; }

 private:
  struct Value {
    const Field* field;
    int index;
    long number;
  };
  const Message* message_;
  Frame frame_;
  std::vector<Value> values_;
};

}  // namespace kaz::hil
