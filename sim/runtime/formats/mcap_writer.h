// Writes MCAP files: channels of time-stamped messages, in chunks with an index.
// SPDX-License-Identifier: Apache-2.0
//
// https://mcap.dev/spec, version 0. Messages are collected in chunks of about a megabyte, each with a CRC and
// a message index; the summary at the end lists schemas, channels and chunks, so that a reader can seek by
// time. Damage is limited to a chunk; if the writer dies, the complete chunks are readable. No compression.
// The same calls produce the same bytes.
#pragma once

#include <cstdint>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"

struct evp_md_ctx_st;  // OpenSSL's digest context

namespace kaz::sim {

// Hears what is written, in the order of the file, on the writer's thread.
class MessageTap {
 public:
  virtual ~MessageTap() = default;
  // Before the first message of the channel. `encoding`: of its messages, "ros1", "json".
  virtual void channel(std::uint16_t number, const std::string& topic, const std::string& encoding,
                       const std::string& schema_name, const std::string& schema_encoding,
                       const std::string& schema) = 0;
  virtual void message(std::uint16_t channel, std::uint64_t time_ns,
                       std::span<const std::uint8_t> data) = 0;
};

class McapWriter {
 public:
  using Metadata = std::vector<std::pair<std::string, std::string>>;
  static constexpr std::size_t chunk_bytes = 1 << 20;

  // Replaces the file at `path`. `library` names the program and its version. The tap, if there is one,
  // must outlive the writer; without a path there is no file, only the tap.
  static Result<std::unique_ptr<McapWriter>> create(const std::string& path,
                                                    const std::string& library,
                                                    MessageTap* tap = nullptr);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  // Metadata of the file. Keys are written in the given order.
  void add_metadata(const std::string& name, const Metadata& entries);
  // Returns the schema's and channel's number. `encoding` of a schema: "ros1msg", "jsonschema".
  std::uint16_t add_schema(const std::string& name, const std::string& encoding,
                           const std::string& text);
  std::uint16_t add_channel(std::uint16_t schema, const std::string& topic,
                            const std::string& message_encoding);
  void add_message(std::uint16_t channel, std::uint64_t time_ns,
                   std::span<const std::uint8_t> data);

  // Finishes the file. Returns the SHA-256 of its bytes, in hexadecimal; empty without a file. Errors:
  // writing failed.
  Result<std::string> finish();
  // Fails (environment) from the first write on that did not succeed.
  Result<void> written() const;
  const std::string& path() const { return path_; }

 private:
  struct Channel {
    std::vector<std::uint8_t> record;                               // content, for the summary
    std::uint32_t messages = 0;                                     // so far
    std::vector<std::pair<std::uint64_t, std::uint64_t>> in_chunk;  // time, offset in it
  };
  struct ChunkIndex {
    std::uint64_t first_ns = 0, last_ns = 0, start = 0, length = 0;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> message_indexes;  // channel, offset
    std::uint64_t indexes_length = 0, size = 0;
  };
  struct MetadataIndex {
    std::uint64_t start, length;
    std::string name;
  };

  McapWriter() = default;
  void put(std::uint8_t opcode, std::span<const std::uint8_t> content);
  void put_bytes(std::span<const std::uint8_t> bytes);
  void put_bytes(std::span<const std::uint8_t> bytes, std::uint32_t crc);
  void end_chunk();
  void put_message_indexes(ChunkIndex& index);
  void put_chunk_index(const ChunkIndex& index);
  void put_statistics();
  void put_summary();

  struct TappedSchema {
    std::string name, encoding, text;
  };

  std::string path_;  // empty: no file
  MessageTap* tap_ = nullptr;
  std::vector<TappedSchema> tapped_;  // as schemas_
  std::ofstream file_;
  int write_error_ = 0;    // errno of the first write that failed
  std::uint64_t at_ = 0;   // bytes written
  std::uint32_t crc_ = 0;  // of the bytes since the last time it was set to 0
  evp_md_ctx_st* digest_ = nullptr;
  std::vector<std::vector<std::uint8_t>> schemas_;  // contents; number n is at n - 1
  std::vector<Channel> channels_;
  std::vector<MetadataIndex> metadata_;
  std::vector<std::uint8_t> chunk_;  // records of the current chunk
  std::uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::vector<ChunkIndex> chunks_;
  std::vector<std::uint8_t> content_;  // of the current record
};

}  // namespace kaz::sim
