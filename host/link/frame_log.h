// The last frames on a link, kept to be shown when it fails.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "shared/protocol/frame.h"
#include "vision/image/frame.h"  // Time

namespace kaz::host {

class FrameLog {
 public:
  static constexpr std::size_t kFrames = 64;

  enum class Direction : std::uint8_t { out, in, damaged };
  void add(Time time, Direction direction, std::span<const std::uint8_t> body);
  std::size_t size() const { return count_ < kFrames ? count_ : kFrames; }

  // One line a frame, oldest first: seconds on the host's clock, direction, message, sequence
  // number, fields by the message table, body in hexadecimal:
  //   "     1.234567  out  enable             #12   mask=0x3  | 01 02 0c 00 00 00 03"
  std::string text() const;

 private:
  struct Entry {
    Time time{};
    Direction direction{};
    std::uint8_t length = 0;
    std::array<std::uint8_t, KZ_BODY_MAX> body{};
  };
  std::array<Entry, kFrames> entries_{};
  std::size_t count_ = 0;
};

// "mask=0x3 duration_ms=500 angle=[0:1000 1:-2]": the fields of a body as the message table has
// them, numbers in the units of the wire. What does not fit the table: "fields do not fit the
// message".
std::string describe_fields(std::span<const std::uint8_t> body);

// "state_reply"; "unknown" for a code that is not in the message table.
const char* message_name(std::uint8_t type);

// "4f 4b 0d", at most `max_bytes` bytes and then "...".
std::string hex(std::span<const std::uint8_t> bytes, std::size_t max_bytes = KZ_BODY_MAX);

}  // namespace kaz::host
