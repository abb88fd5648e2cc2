// Parses the lines of a candump log.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/can_log.h"

#include <algorithm>
#include <optional>

#include "shared/base/number_text.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::tools {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000, kLastExtended = 0x1FFFFFFF;
constexpr Time kLongestLog = std::chrono::hours(24);
constexpr std::size_t kMaxData = 8, kMaxFdData = 64;

// Removes and returns the text before the first `end`; all text if there is no `end`.
std::string_view take_until(std::string_view& text, char end) {
  const auto at = text.find(end);
  const std::string_view taken = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
  return taken;
}

// Parses "1436509052.249713". candump writes six decimals; other programs write up to nine.
std::optional<Time> parse_stamp(std::string_view text) {
  constexpr std::int64_t kMaxSeconds = 8'000'000'000;
  const auto seconds = parse_number<std::int64_t>(take_until(text, '.'));
  if (!seconds || *seconds < 0 || *seconds > kMaxSeconds || text.empty() || text.size() > 9 ||
      !std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; }))
    return std::nullopt;
  std::string digits(text);
  digits.resize(9, '0');
  return std::chrono::seconds(*seconds) + Time(*parse_number<std::int64_t>(digits));
}

bool parse_id(std::string_view text, CanLogFrame& frame) {
  const auto id = parse_number<std::uint32_t>(text, 16);
  if (!id || (text.size() != 3 && text.size() != 8)) return false;
  frame.extended = text.size() == 8;
  frame.id = *id;
  if (!frame.extended) return *id <= 0x7FF;
  if (*id & kErrorFlag) {
    frame.kind = CanLogFrame::Kind::error;
    frame.id = *id & ~kErrorFlag;
  }
  return frame.id <= kLastExtended;
}

// Hexadecimal digits, with or without dots between the bytes.
bool parse_bytes(std::string_view text, std::size_t max, std::vector<std::uint8_t>& bytes) {
  while (!text.empty()) {
    if (text.front() == '.' && !bytes.empty()) text.remove_prefix(1);
    const auto byte = parse_number<std::uint8_t>(text.substr(0, 2), 16);
    if (!byte || text.size() < 2 || bytes.size() == max) return false;
    bytes.push_back(*byte);
    text.remove_prefix(2);
  }
  return true;
}

bool parse_data(std::string_view text, CanLogFrame& frame) {
  if (text.starts_with('#')) {  // CAN FD: one digit of flags, then the data
    frame.kind = CanLogFrame::Kind::fd;
    return text.size() > 1 && parse_number<std::uint8_t>(text.substr(1, 1), 16) &&
           parse_bytes(text.substr(2), kMaxFdData, frame.data);
  }
  if (const auto dlc = text.find('_'); dlc != std::string_view::npos) {
    if (dlc + 2 != text.size() || !parse_number<std::uint8_t>(text.substr(dlc + 1), 16))
      return false;
    text = text.substr(0, dlc);
  }
  if (text.starts_with('R')) {
    frame.kind = CanLogFrame::Kind::remote;
    return text.size() == 1 || (text.size() == 2 && parse_number<std::uint8_t>(text.substr(1)));
  }
  return parse_bytes(text, kMaxData, frame.data);
}

struct StampedFrame {
  Time stamp{};
  CanLogFrame frame;
};

std::optional<StampedFrame> parse_line(std::string_view line) {
  StampedFrame parsed;
  if (!line.starts_with('(')) return std::nullopt;
  line.remove_prefix(1);
  const auto stamp = parse_stamp(take_until(line, ')'));
  if (!stamp || !line.starts_with(' ')) return std::nullopt;
  line.remove_prefix(1);
  parsed.stamp = *stamp;
  parsed.frame.interface = take_until(line, ' ');
  std::string_view frame = take_until(line, ' ');
  if (parsed.frame.interface.empty() || frame.find('#') == std::string_view::npos ||
      !(line.empty() || line == "R" || line == "T") ||
      !parse_id(take_until(frame, '#'), parsed.frame) || !parse_data(frame, parsed.frame))
    return std::nullopt;
  return parsed;
}

}  // namespace

Result<std::vector<CanLogFrame>> parse_can_log(const std::string& name, std::string_view text) {
  std::vector<CanLogFrame> frames;
  Time first{};
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = take_until(text, '\n');
    while (line.ends_with('\r') || line.ends_with(' ')) line.remove_suffix(1);
    if (line.empty()) continue;
    const std::string at = name + ":" + std::to_string(number) + ": ";
    auto parsed = parse_line(line);
    if (!parsed)
      return fail(Fault::usage, at + "'" + shown_text(line) +
                                    "' is not a frame of a CAN log: a line must have the form "
                                    "(SECONDS) INTERFACE ID#DATA, as `candump -l` writes it");
    if (frames.empty()) first = parsed->stamp;
    const Time since = parsed->stamp - first;
    if (since > kLongestLog)
      return fail(Fault::usage, at + "the frame is " +
                                    std::to_string(since / std::chrono::hours(1)) +
                                    " h after the first frame, the limit is 24 h: cut the log");
    parsed->frame.line = number;
    parsed->frame.time = frames.empty() ? Time(0) : std::max(since, frames.back().time);
    frames.push_back(std::move(parsed->frame));
  }
  if (frames.empty())
    return fail(Fault::usage, name + ": contains no frames; record the bus with `candump -l can0`");
  return frames;
}

}  // namespace kaz::tools
