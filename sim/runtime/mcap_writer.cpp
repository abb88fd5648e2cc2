// MCAP records: opcode, length in 8 bytes, content; numbers little-endian.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/mcap_writer.h"

#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "sim/runtime/little_endian.h"
#include "sim/runtime/sha256.h"

namespace kaz::sim {
namespace {

constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum Opcode : std::uint8_t {
  op_header = 0x01,
  op_footer = 0x02,
  op_schema = 0x03,
  op_channel = 0x04,
  op_message = 0x05,
  op_metadata = 0x0C,
  op_data_end = 0x0F,
};

void put_map(LittleEndian& to, const McapWriter::Metadata& entries) {
  std::vector<std::uint8_t> map;
  LittleEndian inside(map);
  for (const auto& [key, value] : entries) inside.text(key).text(value);
  to.number(static_cast<std::uint32_t>(map.size())).bytes(map);
}

}  // namespace

Result<std::unique_ptr<McapWriter>> McapWriter::create(const std::string& path,
                                                       const std::string& library) {
  std::unique_ptr<McapWriter> writer(new McapWriter);
  writer->path_ = path;
  writer->file_.open(path, std::ios::binary | std::ios::trunc);
  if (!writer->file_)
    return fail(Fault::environment, "cannot write the recording " + path + ": " +
                                        std::strerror(errno) + "; choose another folder");
  writer->digest_ = EVP_MD_CTX_new();
  if (!writer->digest_ || EVP_DigestInit_ex(writer->digest_, EVP_sha256(), nullptr) != 1)
    return fail(Fault::environment, "OpenSSL has no SHA-256; check the libssl installation");
  writer->put_bytes(magic);
  writer->content_.clear();
  LittleEndian(writer->content_).text("").text(library);
  writer->put(op_header, writer->content_);
  return writer;
}

McapWriter::~McapWriter() {
  EVP_MD_CTX_free(digest_);
}

void McapWriter::put_bytes(std::span<const std::uint8_t> bytes) {
  file_.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  EVP_DigestUpdate(digest_, bytes.data(), bytes.size());
}

void McapWriter::put(std::uint8_t opcode, std::span<const std::uint8_t> content) {
  std::array<std::uint8_t, 9> head{opcode};
  for (std::size_t i = 0; i < 8; ++i)
    head[1 + i] = static_cast<std::uint8_t>(std::uint64_t{content.size()} >> (8 * i));
  put_bytes(head);
  put_bytes(content);
}

void McapWriter::add_metadata(const std::string& name, const Metadata& entries) {
  content_.clear();
  LittleEndian record(content_);
  record.text(name);
  put_map(record, entries);
  put(op_metadata, content_);
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding,
                                     const std::string& text) {
  const std::uint16_t id = ++schemas_;  // 0 means "no schema"
  content_.clear();
  LittleEndian(content_).number(id).text(name).text(encoding).text(text);
  put(op_schema, content_);
  return id;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema, const std::string& topic,
                                      const std::string& message_encoding) {
  const std::uint16_t id = channels_++;
  sequences_.push_back(0);
  content_.clear();
  LittleEndian record(content_);
  record.number(id).number(schema).text(topic).text(message_encoding);
  put_map(record, {});
  put(op_channel, content_);
  return id;
}

void McapWriter::add_message(std::uint16_t channel, std::uint64_t time_ns,
                             std::span<const std::uint8_t> data) {
  content_.clear();
  LittleEndian(content_)
      .number(channel)
      .number(sequences_[channel]++)
      .number(time_ns)  // when it was recorded
      .number(time_ns)  // when it was published
      .bytes(data);
  put(op_message, content_);
}

Result<std::string> McapWriter::finish() {
  content_.clear();
  LittleEndian(content_).number(std::uint32_t{0});  // no CRC of the data section
  put(op_data_end, content_);
  content_.clear();
  // No summary section: its two offsets and its CRC are 0.
  LittleEndian(content_).number(std::uint64_t{0}).number(std::uint64_t{0}).number(std::uint32_t{0});
  put(op_footer, content_);
  put_bytes(magic);
  file_.close();
  if (!file_)
    return fail(Fault::environment,
                "cannot finish the recording " + path_ + "; check the space on its disk");
  std::array<std::uint8_t, 32> digest{};
  EVP_DigestFinal_ex(digest_, digest.data(), nullptr);
  return hex(digest);
}

}  // namespace kaz::sim
