// Writes MCAP files: channels of time-stamped messages, in chunks with an index.
// SPDX-License-Identifier: Apache-2.0
//
// Format: https://mcap.dev/spec, version 0, without compression. Messages are collected in chunks of about
// 1 MB, each with a CRC and a message index. The summary at the end lists schemas, channels and chunks, so
// that a reader can seek by time. Damaged bytes affect only the chunk that contains them. If the program is
// killed, all complete chunks are readable. The same calls produce the same bytes.
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

// Observes the written channels and messages. McapWriter calls these functions in the order in which channels
// and messages are added. Each call runs on the thread that adds the channel or the message.
class MessageTap {
 public:
  virtual ~MessageTap() = default;
  // Called before the channel's first message. `encoding` is the encoding of the messages: "ros1" or "json".
  virtual void channel(std::uint16_t number, const std::string& topic, const std::string& encoding,
                       const std::string& schema_name, const std::string& schema_encoding,
                       const std::string& schema) = 0;
  virtual void message(std::uint16_t channel, std::uint64_t time_ns,
                       std::span<const std::uint8_t> data) = 0;
};

class McapWriter {
 public:
  using Metadata = std::vector<std::pair<std::string, std::string>>;
  static constexpr std::size_t kChunkBytes = 1 << 20;

  // Replaces the file at `path`. If `path` is empty, no file is written and only the tap receives messages.
  // `library` names the program and its version. `tap` may be null and must outlive the writer. Returns
  // Fault::environment if the file cannot be created.
  static Result<std::unique_ptr<McapWriter>> create(const std::string& path,
                                                    const std::string& library,
                                                    MessageTap* tap = nullptr);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  // Adds a metadata record. Keys are written in the given order.
  void add_metadata(const std::string& name, const Metadata& entries);
  // Adds a schema or a channel and returns its number. `encoding` of a schema: "ros1msg" or "jsonschema".
  std::uint16_t add_schema(const std::string& name, const std::string& encoding,
                           const std::string& text);
  std::uint16_t add_channel(std::uint16_t schema, const std::string& topic,
                            const std::string& message_encoding);
  void add_message(std::uint16_t channel, std::uint64_t time_ns,
                   std::span<const std::uint8_t> data);

  // Finishes the file and returns the SHA-256 of its bytes in hexadecimal. Returns an empty string if no file
  // is written. Returns Fault::environment if a write has failed.
  Result<std::string> finish();
  // Returns Fault::environment once a write has failed.
  Result<void> written() const;
  const std::string& path() const { return path_; }

 private:
  struct Channel {
    // Content of the channel record. The summary contains a copy of this record.
    std::vector<std::uint8_t> record;
    std::uint32_t messages = 0;  // number of messages written so far
    // One pair for each message of this channel in the current chunk: time and offset of the message.
    std::vector<std::pair<std::uint64_t, std::uint64_t>> in_chunk;
  };
  struct ChunkIndex {
    std::uint64_t first_ns = 0, last_ns = 0, start = 0, length = 0;
    // One pair for each channel in the chunk: channel number, and offset of the channel's message index.
    std::vector<std::pair<std::uint16_t, std::uint64_t>> message_indexes;
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

  std::string path_;  // empty: no file is written
  MessageTap* tap_ = nullptr;
  std::vector<TappedSchema> tapped_;  // schemas for the tap, in the order of `schemas_`
  std::ofstream file_;
  int write_error_ = 0;    // errno of the first failed write
  std::uint64_t at_ = 0;   // bytes written
  std::uint32_t crc_ = 0;  // CRC of the written bytes of the current section (data or summary)
  evp_md_ctx_st* digest_ = nullptr;
  // Contents of the schema records. Schema number n is at index n - 1.
  std::vector<std::vector<std::uint8_t>> schemas_;
  std::vector<Channel> channels_;
  std::vector<MetadataIndex> metadata_;
  std::vector<std::uint8_t> chunk_;  // records of the current chunk
  std::uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::vector<ChunkIndex> chunks_;
  std::vector<std::uint8_t> content_;  // content of the current record
};

}  // namespace kaz::sim
