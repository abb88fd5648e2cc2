// A ring of frames and its text.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/frame_log.h"

#include <algorithm>
#include <cstdio>

#include "shared/base/hex_text.hpp"
#include "shared/protocol/message_info.h"

namespace kaz::host {

const char* message_name(std::uint8_t type) {
  const kz_message_info* info = kz_message_find(type);
  return info ? info->name : "unknown";
}

std::string hex(std::span<const std::uint8_t> bytes, std::size_t max_bytes) {
  const std::string text = hex_text(bytes.first(std::min(bytes.size(), max_bytes)), " ");
  return bytes.size() > max_bytes ? text + " ..." : text;
}

namespace {

struct Reader {
  std::span<const std::uint8_t> bytes;
  bool enough(std::size_t count) const { return bytes.size() >= count; }
  std::int64_t next(const kz_field_info& field) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < field.size; ++i) value = value << 8 | bytes[i];
    bytes = bytes.subspan(field.size);
    return field.type[0] == 's' ? static_cast<std::int16_t>(value) : std::int64_t{value};
  }
};

// Appended piece by piece: operator+ on literals trips a false warning of g++ 12 (-Wrestrict).
std::string quoted(const char* words) {
  std::string text = "'";
  text += words;
  text += '\'';
  return text;
}

std::string status_text(std::uint16_t status) {
  std::string text;
  const auto add = [&](const std::string& part) {
    if (!text.empty()) text += '+';
    text += part;
  };
  for (int bit = 0; bit < 8; ++bit) {
    const char* name = kz_status_name(static_cast<u16>(status & 1u << bit));
    if (name) add(name);
  }
  if (status >> 8) add(quoted(kz_shutdown_text(static_cast<u8>(status >> 8))));
  return text.empty() ? "0" : text;
}

std::string value_text(const kz_message_info& message, const kz_field_info& field,
                       std::int64_t value) {
  const std::string_view name = field.name;
  if (name == "status") return status_text(static_cast<std::uint16_t>(value));
  if (name == "mask") {
    char digits[24];
    std::snprintf(digits, sizeof digits, "0x%llx", static_cast<unsigned long long>(value));
    return digits;
  }
  if (message.code == KZ_TYPE_refused && name == "request") {
    return message_name(static_cast<std::uint8_t>(value));
  }
  if (message.code == KZ_TYPE_refused && name == "reason") {
    return quoted(kz_refusal_text(static_cast<u8>(value)));
  }
  return std::to_string(value);
}

}  // namespace

std::string describe_fields(std::span<const std::uint8_t> body) {
  constexpr const char* kNoFit = "fields do not fit the message";
  const kz_message_info* message =
      body.size() >= KZ_HEADER_SIZE ? kz_message_find(body[1]) : nullptr;
  if (!message) return kNoFit;
  Reader reader{body.subspan(KZ_HEADER_SIZE)};
  std::string text;
  std::uint32_t mask = 0;
  for (std::size_t f = 0; f < message->field_count; ++f) {
    const kz_field_info& field = message->fields[f];
    if (f) text += ' ';
    text += field.name;
    text += '=';
    if (field.count == 1 && !field.mask) {
      if (!reader.enough(field.size)) return kNoFit;
      const std::int64_t value = reader.next(field);
      if (std::string_view(field.name) == "mask") mask = static_cast<std::uint32_t>(value);
      text += value_text(*message, field, value);
      continue;
    }
    text += '[';
    int taken = 0;
    for (int j = 0; j < KZ_JOINTS && taken < field.count; ++j) {
      if (field.mask && !(mask >> j & 1)) continue;
      if (!reader.enough(field.size)) return kNoFit;
      if (taken++) text += ' ';
      if (field.mask) text += std::to_string(j) + ':';
      text += std::to_string(reader.next(field));
    }
    text += ']';
  }
  return reader.bytes.empty() ? text : kNoFit;
}

void FrameLog::add(Time time, Direction direction, std::span<const std::uint8_t> body) {
  Entry& entry = entries_[count_++ % kFrames];
  entry.time = time;
  entry.direction = direction;
  entry.length = static_cast<std::uint8_t>(std::min(body.size(), entry.body.size()));
  std::copy_n(body.begin(), entry.length, entry.body.begin());
}

std::string FrameLog::text() const {
  std::string text;
  for (std::size_t i = count_ - size(); i < count_; ++i) {
    const Entry& entry = entries_[i % kFrames];
    const bool whole = entry.direction != Direction::damaged && entry.length >= KZ_HEADER_SIZE;
    const char* direction = entry.direction == Direction::out  ? "out"
                            : entry.direction == Direction::in ? "in "
                                                               : "bad";
    char line[64];
    std::snprintf(line, sizeof line, "%13.6f  %s  %-16s #%-3d  ", seconds(entry.time), direction,
                  whole ? message_name(entry.body[1]) : "damaged", whole ? entry.body[2] : 0);
    const std::span<const std::uint8_t> body(entry.body.data(), entry.length);
    text += line;
    if (whole) text += describe_fields(body) + "  ";
    text += "| " + hex(body) + "\n";
  }
  return text;
}

}  // namespace kaz::host
