// Where two messages of a recording differ, in the terms of their channel.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/message_fields.h"

#include <bit>
#include <cstdio>
#include <iterator>

namespace kaz::tools {
namespace {

// The fields of the schemas in sim/runtime/simulation/recorder.cpp that have a fixed length.
struct Field {
  const char* topic;
  const char* name;
  std::size_t count, bytes;  // bytes of one; 8: a double, else an unsigned number
};
constexpr Field kFields[] = {
    {"/board/pins", "pw", 16, 2},
    {"/board/pins", "tmo", 2, 2},
    {"/board/pins", "p3", 1, 1},
    {"/board/pins", "p4", 1, 1},
    {"/board/pins", "p5", 1, 1},
    {"/board/pins", "p6", 1, 1},
    {"/board/analog", "tick", 1, 4},
    {"/board/analog", "code", 24, 2},
    {"/truth/joints", "angle", 18, 8},
    {"/truth/joints", "torque", 18, 8},
    {"/truth/joints", "winding_celsius", 18, 8},
    {"/truth/ball", "x", 1, 8},
    {"/truth/ball", "y", 1, 8},
    {"/truth/ball", "z", 1, 8},
    {"/board/supply", "volts", 1, 8},
    {"/board/supply", "amperes", 1, 8},
    {"/truth/joint_loads", "force", 54, 8},
    {"/truth/joint_loads", "moment", 54, 8},
};

std::string value(std::span<const std::uint8_t> bytes) {
  std::uint64_t bits = 0;
  for (std::size_t k = bytes.size(); k-- > 0;) bits = bits << 8 | bytes[k];
  char text[40];
  if (bytes.size() == 8) {
    std::snprintf(text, sizeof text, "%.17g", std::bit_cast<double>(bits));
  } else {
    std::snprintf(text, sizeof text, "%llu", static_cast<unsigned long long>(bits));
  }
  return text;
}

}  // namespace

std::optional<FieldDifference> field_difference(std::string_view topic,
                                                std::span<const std::uint8_t> recorded,
                                                std::span<const std::uint8_t> now) {
  if (recorded.size() != now.size()) return std::nullopt;
  std::optional<FieldDifference> found;
  std::size_t at = 0, more = 0;
  for (const Field& field : kFields) {
    if (topic != field.topic) continue;
    for (std::size_t k = 0; k < field.count; ++k, at += field.bytes) {
      if (at + field.bytes > recorded.size()) return std::nullopt;
      const std::string then = value(recorded.subspan(at, field.bytes));
      const std::string here = value(now.subspan(at, field.bytes));
      if (then == here) continue;
      if (found) {
        ++more;
        continue;
      }
      std::string name = field.name;
      if (field.count > 1) name.append("[").append(std::to_string(k)).append("]");
      found = FieldDifference{name + " = " + then, name + " = " + here};
    }
  }
  if (at != recorded.size()) return std::nullopt;
  if (found && more > 0) found->now += " (" + std::to_string(more) + " more numbers differ)";
  return found;
}

}  // namespace kaz::tools
