// Ring buffer of the last frames on a link, printed when the link fails.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "shared/base/time.hpp"
#include "shared/protocol/frame.h"

namespace kaz::host {

class FrameLog {
 public:
  static constexpr std::size_t kFrames = 64;

  enum class Direction : std::uint8_t { out, in, damaged };
  // Adds a frame. The log keeps only the last kFrames frames. `body` is truncated to KZ_BODY_MAX bytes.
  void add(Time time, Direction direction, std::span<const std::uint8_t> body);
  std::size_t size() const { return count_ < kFrames ? count_ : kFrames; }

  // Returns one line per frame, oldest first. A line contains host time in seconds, direction, message,
  // sequence number, fields as defined by the message table, and body in hexadecimal:
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

// Returns the fields of a body, as defined by the message table, in wire units: "mask=0x3 duration_ms=500
// angle=[0:1000 1:-2]". If the body does not match the table, returns "fields do not fit the message".
std::string describe_fields(std::span<const std::uint8_t> body);

// Message name, such as "state_reply"; "unknown" if the code is not in the message table.
const char* message_name(std::uint8_t type);

// Returns at most `max_bytes` bytes in hexadecimal, such as "4f 4b 0d", then "..." if there are more bytes.
std::string hex(std::span<const std::uint8_t> bytes, std::size_t max_bytes = KZ_BODY_MAX);

}  // namespace kaz::host
