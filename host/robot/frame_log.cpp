// A ring of frames and its text.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/frame_log.h"

#include <algorithm>
#include <cstdio>

#include "shared/protocol/message_info.h"

namespace kaz::host {

const char* message_name(std::uint8_t type) {
  const kz_message_info* info = kz_message_find(type);
  return info ? info->name : "unknown";
}

std::string hex(std::span<const std::uint8_t> bytes, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(bytes.size(), most); ++i) {
    char digits[4];
    std::snprintf(digits, sizeof digits, "%s%02x", i ? " " : "", bytes[i]);
    text += digits;
  }
  return bytes.size() > most ? text + " ..." : text;
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
    text += line + hex({entry.body.data(), entry.length}) + "\n";
  }
  return text;
}

}  // namespace kaz::host
