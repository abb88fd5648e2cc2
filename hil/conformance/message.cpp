// The message table as data for the cases.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/message.h"

#include <bit>
#include <stdexcept>

#include "hil/report/check.h"
#include "shared/protocol/messages.h"

namespace kaz::hil {
namespace {

Field field_of(std::string_view type, const char* name) {
  Field field;
  field.name = name;
  field.size = type == "u8" ? 1 : type == "u32" ? 4 : 2;
  field.is_signed = type == "s16";
  return field;
}

std::vector<Message> table() {
  std::vector<Message> all;
#define KZ_MESSAGE(name, code, kind, text) all.push_back({#name, code, KZ_KIND_##kind, {}});
#define KZ_FIELD(type, name, unit, text) all.back().fields.push_back(field_of(#type, #name));
#define KZ_BOUNDED(type, name, lowest_value, highest_value, unit, text) \
  all.back().fields.push_back(field_of(#type, #name));                  \
  all.back().fields.back().bounded = true;                              \
  all.back().fields.back().low = lowest_value;                          \
  all.back().fields.back().high = highest_value;
#define KZ_ARRAY(type, name, number, unit, text)       \
  all.back().fields.push_back(field_of(#type, #name)); \
  all.back().fields.back().count = number;
#define KZ_MASKED(type, name, mask, most, unit, text)  \
  all.back().fields.push_back(field_of(#type, #name)); \
  all.back().fields.back().count = most;               \
  all.back().fields.back().masked = true;
#include "shared/protocol/messages.def"
  return all;
}

}  // namespace

const std::vector<Message>& messages() {
  static const std::vector<Message> all = table();
  return all;
}

const Message& message(std::string_view name) {
  for (const Message& one : messages()) {
    if (one.name == name) return one;
  }
  throw std::logic_error("no message " + std::string(name));
}

Put& Put::number(long value, int size) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) {
    bytes_.push_back(static_cast<std::uint8_t>(value >> shift & 0xFF));
  }
  return *this;
}

Bytes legal_fields(const Message& request, int changed, long value) {
  Put put;
  unsigned long mask = 0;
  for (std::size_t i = 0; i < request.fields.size(); ++i) {
    const Field& field = request.fields[i];
    const bool is_changed = static_cast<int>(i) == changed;
    const long number = is_changed ? value : field.bounded ? field.low : 0;
    if (field.name == "mask") mask = static_cast<unsigned long>(number) & KZ_ALL_JOINTS;
    const int count = field.masked ? std::popcount(mask) : field.count;
    for (int n = 0; n < count; ++n) put.number(number, field.size);
  }
  return put;
}

Reply::Reply(const Message& message, const Frame& frame) : message_(&message), frame_(frame) {
  std::size_t at = 0;
  unsigned long mask = 0;
  for (const Field& field : message.fields) {
    const int places = field.masked ? KZ_JOINTS : field.count;
    for (int index = 0; index < places; ++index) {
      if (field.masked && !(mask >> index & 1)) continue;
      check(at + static_cast<std::size_t>(field.size) <= frame.fields.size(),
            message.name + " ends before its field " + field.name);
      long number = 0;
      for (int n = 0; n < field.size; ++n) number = number << 8 | frame.fields[at++];
      if (field.is_signed && number > field.highest()) number -= 1L << (8 * field.size);
      values_.push_back({&field, index, number});
      if (field.name == "mask") mask = static_cast<unsigned long>(number);
    }
  }
  equal(message.name + ": number of field bytes", static_cast<long>(frame.fields.size()),
        static_cast<long>(at));
}

long Reply::number(std::string_view name, int index) const {
  for (const Value& value : values_) {
    if (value.field->name == name && value.index == index) return value.number;
  }
  throw Failed{message_->name + " has no " + std::string(name) + " " + std::to_string(index)};
}

}  // namespace kaz::hil
