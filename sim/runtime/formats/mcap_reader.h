// Reads MCAP files as written by McapWriter: chunks without compression.
// SPDX-License-Identifier: Apache-2.0
//
// A truncated file (program killed, disk full) is valid up to its end: it ends within a top-level record or
// before the data end record, and `whole` is false. Other deviations from the format are errors: fields
// beyond the end of their record, nested chunks, impossible record lengths, unknown channels, times out of
// range. A chunk with a wrong CRC is skipped and counted.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

struct McapRecording {
  // A recording is kept in memory, beside its file while that is read. docs/explanation/time.md has the
  // limits.
  static constexpr std::uint64_t max_bytes = std::uint64_t{2} << 30;
  static constexpr std::size_t max_facts = 10'000;
  // The fact of a recording whose run was interrupted: the signal's name.
  static constexpr const char* kInterrupted = "interrupted";
  // A year: far above any run, and low enough that it can be counted in crystal periods (time.h).
  static constexpr std::uint64_t max_time_ns = 366ull * 24 * 3600 * 1'000'000'000;

  struct Message {
    std::uint16_t channel = 0;
    std::uint64_t time_ns = 0;
    std::vector<std::uint8_t> data;
    bool operator==(const Message&) const = default;
  };
  std::map<std::uint16_t, std::string> topics;  // by channel
  std::map<std::string, std::string> facts;     // of all metadata records
  std::vector<Message> messages;   // in the order of the file; their channels are known
  std::size_t damaged_chunks = 0;  // their CRC is wrong; skipped
  bool whole = false;              // false: the file is truncated

  std::size_t count(const std::string& topic) const;
  bool has_messages(const std::string& topic) const { return count(topic) > 0; }
  // The signal that interrupted the run, "SIGINT"; empty: none.
  std::string interrupted_by() const;
  // Whether the run went on after what is recorded: the file is truncated, or the run was interrupted.
  bool ends_early() const { return !whole || !interrupted_by().empty(); }
  // The latest time of a message; 0 if there is none.
  std::uint64_t end_ns() const;

  // Errors (usage), one sentence with the file's name: no such file, no MCAP file, larger than
  // max_bytes, malformed, compressed.
  static Result<McapRecording> load(const std::string& path);
  // The same of a file's content; `name` stands in the errors.
  static Result<McapRecording> parse(std::span<const std::uint8_t> bytes, const std::string& name);
};

}  // namespace kaz::sim
