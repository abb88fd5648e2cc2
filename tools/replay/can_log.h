// Reads logs of a CAN bus in the format of can-utils (`candump -l`, `candump -L`).
// SPDX-License-Identifier: Apache-2.0
//
// A line is "(SECONDS) INTERFACE ID#DATA". ID has 3 hexadecimal digits, or 8 digits for an extended
// identifier or an error frame. The other forms are ID#R for a remote frame, ID##FLAGS DATA for CAN FD, and
// DATA with a raw DLC ("_9"). A direction (R or T) may follow. Source: lib.h of can-utils.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"

namespace kaz::tools {

struct CanLogFrame {
  enum class Kind : std::uint8_t { data, remote, error, fd };
  std::size_t line = 0;        // line of the log, from 1
  Time time{};                 // since the first frame of the log; never decreases
  std::string_view interface;  // refers to the text of the log
  std::uint32_t id = 0;        // 11 or 29 bits; for an error frame, the error class
  bool extended = false;
  Kind kind = Kind::data;
  std::vector<std::uint8_t> data;  // at most 8 bytes; CAN FD: at most 64 bytes; remote: empty
};

// Parses a log. `name` identifies the log in errors. Empty lines are skipped. If a frame is earlier than the
// frame before it, as with several interfaces, the frame gets the time of that frame. Fails (usage) with the
// line number if a line has another form, or is more than a day after the first frame. Fails (usage) if there
// are no frames. `text` must outlive the frames.
Result<std::vector<CanLogFrame>> parse_can_log(const std::string& name, std::string_view text);

}  // namespace kaz::tools
