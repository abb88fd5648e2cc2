// Writes MCAP files: channels of time-stamped messages, appended as they come.
// SPDX-License-Identifier: Apache-2.0
//
// https://mcap.dev/spec, version 0. Readable up to the last whole record if the writer dies. Chunks
// and indexes, which are optional, are left out. The same calls give the same bytes.
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

class McapWriter {
 public:
  using Metadata = std::vector<std::pair<std::string, std::string>>;

  // Replaces the file at `path`. `library` names the program and its version.
  static Result<std::unique_ptr<McapWriter>> create(const std::string& path,
                                                    const std::string& library);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  // Facts about the whole file. Keys are written in the given order.
  void add_metadata(const std::string& name, const Metadata& entries);
  // Returns the schema's and channel's number. `encoding` of a schema: "ros1msg", "jsonschema".
  std::uint16_t add_schema(const std::string& name, const std::string& encoding,
                           const std::string& text);
  std::uint16_t add_channel(std::uint16_t schema, const std::string& topic,
                            const std::string& message_encoding);
  void add_message(std::uint16_t channel, std::uint64_t time_ns,
                   std::span<const std::uint8_t> data);

  // Ends the file. Returns the SHA-256 of its bytes, in hexadecimal. Errors: disk full and the
  // like.
  Result<std::string> finish();
  const std::string& path() const { return path_; }

 private:
  McapWriter() = default;
  void put(std::uint8_t opcode, std::span<const std::uint8_t> content);
  void put_bytes(std::span<const std::uint8_t> bytes);

  std::string path_;
  std::ofstream file_;
  evp_md_ctx_st* digest_ = nullptr;
  std::uint16_t schemas_ = 0, channels_ = 0;
  std::vector<std::uint32_t> sequences_;  // of each channel
  std::vector<std::uint8_t> content_;     // of the record being made
};

}  // namespace kaz::sim
