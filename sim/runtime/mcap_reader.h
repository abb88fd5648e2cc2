// Reads MCAP files as McapWriter makes them: chunks without compression.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

struct McapRecording {
  struct Message {
    std::uint16_t channel = 0;
    std::uint64_t time_ns = 0;
    std::vector<std::uint8_t> data;
    bool operator==(const Message&) const = default;
  };
  std::map<std::uint16_t, std::string> topics;  // by channel
  std::map<std::string, std::string> facts;     // of all metadata records
  std::vector<Message> messages;                // in the order of the file
  std::size_t damaged_chunks = 0;               // their CRC is wrong; left out
  bool whole = false;                           // the file's end is there

  bool has_messages(const std::string& topic) const;

  // Errors (usage): no such file, no MCAP file, compressed.
  static Result<McapRecording> load(const std::string& path);
};

}  // namespace kaz::sim
