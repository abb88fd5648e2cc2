// Reads MCAP files of Kaz (McapWriter) and of other programs: chunks without compression, with lz4 or zstd.
// SPDX-License-Identifier: Apache-2.0
//
// A file may be truncated because the program was killed or the disk was full. A truncated file ends within a
// top-level record, or the Data End record is missing. A truncated file is read up to the end, and `whole` is
// false. A chunk with a wrong CRC is skipped and counted. Other deviations from the format are errors.
// Examples of errors are fields beyond the end of the record, nested chunks, impossible record lengths,
// unknown channels, and compressed data that does not have the stated size.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

struct McapRecording {
  // Limits (docs/reference/recording.md). The recording is kept in memory. During load(), the bytes of the
  // file are in memory, too. kMaxBytes limits the file, and also the sum of its decompressed chunks.
  static constexpr std::uint64_t kMaxBytes = 2ull << 30;
  static constexpr std::uint64_t kMaxChunkBytes = 256ull << 20;  // limit of a decompressed chunk
  static constexpr std::size_t kMaxFacts = 10'000;
  // Key of an entry in `facts`. If a signal interrupted the run, the value of this entry is the name of the
  // signal.
  static constexpr const char* kInterrupted = "interrupted";
  // Limit of message times in a recording of Kaz: one year, which is longer than any run. Times up to this
  // limit can be converted to crystal periods (time.h) without overflow. Files of other programs usually have
  // times since 1970.
  static constexpr std::uint64_t kMaxTime_ns = 366ull * 24 * 3600 * 1'000'000'000;

  struct Message {
    std::uint16_t channel = 0;
    std::uint64_t time_ns = 0;
    std::vector<std::uint8_t> data;
    bool operator==(const Message&) const = default;
  };
  struct Schema {
    std::string name, encoding, text;
    bool operator==(const Schema&) const = default;
  };
  struct Encoding {
    std::string message;       // such as "ros1", "cdr" or "json"
    std::uint16_t schema = 0;  // its number. `schemas` may lack it; 0: the channel has no schema
    bool operator==(const Encoding&) const = default;
  };
  std::map<std::uint16_t, std::string> topics;  // topic of each channel number
  std::map<std::uint16_t, Encoding> encodings;  // the same keys as `topics`
  std::map<std::uint16_t, Schema> schemas;      // by schema number
  // Entries of all metadata records. If two records have the same key, the later entry counts.
  std::map<std::string, std::string> facts;
  std::vector<Message> messages;   // in file order; `topics` contains the channel of every message
  std::size_t damaged_chunks = 0;  // number of chunks skipped because of a wrong CRC
  bool whole = false;              // false: the file is truncated
  bool has_kaz_metadata = false;   // whether Kaz recorded it: it has the metadata record `kaz`

  std::size_t count(const std::string& topic) const;
  bool has_messages(const std::string& topic) const { return count(topic) > 0; }
  // Returns the signal that interrupted the run, such as "SIGINT". Empty if the run was not interrupted.
  std::string interrupted_by() const;
  // Returns whether the file is truncated or the run was interrupted.
  bool ends_early() const { return !whole || !interrupted_by().empty(); }
  // Returns the time of the latest message, or 0 without messages.
  std::uint64_t end_ns() const;
  // Returns the duration. A recording of Kaz begins at time 0, other files at their earliest message.
  std::uint64_t duration_ns() const;
  // Returns Fault::usage if this is a file of another program, or a time is above kMaxTime_ns. A file that is
  // truncated before its first message passes. `name` is the file name for error messages.
  Result<void> check_run(const std::string& name) const;

  // Reads a file of any program. Returns Fault::usage if the file is missing, is not an MCAP file, is larger
  // than kMaxBytes, is malformed, or has an unknown compression. The error message is one sentence that names
  // the file.
  static Result<McapRecording> load(const std::string& path);
  // Reads a recording of Kaz, with the errors of load() and check_run().
  static Result<McapRecording> load_run(const std::string& path);
  // Parses the contents of a file, with the same errors as load(). `name` is the file name for error
  // messages.
  static Result<McapRecording> parse(std::span<const std::uint8_t> bytes, const std::string& name);
};

}  // namespace kaz::sim
