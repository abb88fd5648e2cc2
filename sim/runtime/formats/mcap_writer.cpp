// MCAP records: opcode, length in 8 bytes, content; numbers little-endian.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/mcap_writer.h"

#include <openssl/evp.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "shared/base/files.hpp"
#include "shared/base/hex_text.hpp"
#include "sim/runtime/formats/little_endian.h"

namespace kaz::sim {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum Opcode : std::uint8_t {
  op_header = 0x01,
  op_footer = 0x02,
  op_schema = 0x03,
  op_channel = 0x04,
  op_message = 0x05,
  op_chunk = 0x06,
  op_message_index = 0x07,
  op_chunk_index = 0x08,
  op_statistics = 0x0B,
  op_metadata = 0x0C,
  op_metadata_index = 0x0D,
  op_data_end = 0x0F,
};

using Bytes = std::vector<std::uint8_t>;

std::uint32_t crc_of(std::span<const std::uint8_t> bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

void put_map(LittleEndian& to, const McapWriter::Metadata& entries) {
  Bytes map;
  LittleEndian inside(map);
  for (const auto& [key, value] : entries) inside.text(key).text(value);
  to.number(static_cast<std::uint32_t>(map.size())).bytes(map);
}

// An array or map of pairs of numbers: its length in bytes, then the pairs.
template <class A, class B>
void put_pairs(LittleEndian& to, const std::vector<std::pair<A, B>>& pairs) {
  to.number(static_cast<std::uint32_t>(pairs.size() * (sizeof(A) + sizeof(B))));
  for (const auto& [a, b] : pairs) to.number(a).number(b);
}

}  // namespace

Result<std::unique_ptr<McapWriter>> McapWriter::create(const std::string& path,
                                                       const std::string& library,
                                                       MessageTap* tap) {
  std::unique_ptr<McapWriter> writer(new McapWriter);
  writer->path_ = path;
  writer->tap_ = tap;
  if (path.empty()) return writer;
  writer->file_.open(path, std::ios::binary | std::ios::trunc);
  if (!writer->file_)
    return fail(Fault::environment, "cannot write the recording " + path + ": " +
                                        std::strerror(errno) + "; choose another folder");
  writer->digest_ = EVP_MD_CTX_new();
  if (!writer->digest_ || EVP_DigestInit_ex(writer->digest_, EVP_sha256(), nullptr) != 1)
    return fail(Fault::environment, "OpenSSL has no SHA-256; check the libssl installation");
  writer->put_bytes(kMagic);
  writer->content_.clear();
  LittleEndian(writer->content_).text("").text(library);
  writer->put(op_header, writer->content_);
  return writer;
}

McapWriter::~McapWriter() {
  EVP_MD_CTX_free(digest_);
}

void McapWriter::put_bytes(std::span<const std::uint8_t> bytes) {
  put_bytes(bytes, crc_of(bytes));
}

// `crc`: of the bytes.
void McapWriter::put_bytes(std::span<const std::uint8_t> bytes, std::uint32_t crc) {
  if (path_.empty()) return;
  if (write_error_ == 0) errno = 0;
  file_.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  if (!file_ && write_error_ == 0) write_error_ = errno;
  EVP_DigestUpdate(digest_, bytes.data(), bytes.size());
  at_ += bytes.size();
  crc_ = static_cast<std::uint32_t>(crc32_combine(crc_, crc, static_cast<z_off_t>(bytes.size())));
}

void McapWriter::put(std::uint8_t opcode, std::span<const std::uint8_t> content) {
  Bytes head;
  LittleEndian(head).number(opcode).number(std::uint64_t{content.size()});
  put_bytes(head);
  put_bytes(content);
}

void McapWriter::add_metadata(const std::string& name, const Metadata& entries) {
  content_.clear();
  LittleEndian record(content_);
  record.text(name);
  put_map(record, entries);
  metadata_.push_back({at_, 9 + content_.size(), name});
  put(op_metadata, content_);
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding,
                                     const std::string& text) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);  // 0 means "no schema"
  content_.clear();
  LittleEndian(content_).number(id).text(name).text(encoding).text(text);
  schemas_.push_back(content_);
  if (tap_ != nullptr) tapped_.push_back({name, encoding, text});
  put(op_schema, content_);
  return id;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema, const std::string& topic,
                                      const std::string& message_encoding) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  content_.clear();
  LittleEndian record(content_);
  record.number(id).number(schema).text(topic).text(message_encoding);
  put_map(record, {});
  channels_.push_back({content_, 0, {}});
  put(op_channel, content_);
  if (tap_ != nullptr) {
    const TappedSchema& of = tapped_[schema - 1u];
    tap_->channel(id, topic, message_encoding, of.name, of.encoding, of.text);
  }
  return id;
}

void McapWriter::add_message(std::uint16_t channel, std::uint64_t time_ns,
                             std::span<const std::uint8_t> data) {
  if (tap_ != nullptr) tap_->message(channel, time_ns, data);
  if (path_.empty()) return;
  Channel& of = channels_[channel];
  if (chunk_.empty()) chunk_first_ns_ = chunk_last_ns_ = time_ns;
  chunk_first_ns_ = std::min(chunk_first_ns_, time_ns);
  chunk_last_ns_ = std::max(chunk_last_ns_, time_ns);
  of.in_chunk.emplace_back(time_ns, chunk_.size());
  LittleEndian(chunk_)
      .number(std::uint8_t{op_message})
      .number(std::uint64_t{22 + data.size()})
      .number(channel)
      .number(of.messages++)
      .number(time_ns)  // when it was recorded
      .number(time_ns)  // when it was published
      .bytes(data);
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  ChunkIndex index;
  index.first_ns = chunk_first_ns_;
  index.last_ns = chunk_last_ns_;
  index.start = at_;
  index.size = chunk_.size();
  const std::uint32_t crc = crc_of(chunk_);
  content_.clear();
  LittleEndian(content_)
      .number(std::uint8_t{op_chunk})
      .number(std::uint64_t{40 + chunk_.size()})
      .number(chunk_first_ns_)
      .number(chunk_last_ns_)
      .number(std::uint64_t{chunk_.size()})
      .number(crc)
      .text("")  // no compression
      .number(std::uint64_t{chunk_.size()});
  put_bytes(content_);
  put_bytes(chunk_, crc);
  index.length = at_ - index.start;
  put_message_indexes(index);
  chunks_.push_back(std::move(index));
  chunk_.clear();
}

// Message index of the chunk: for each channel, pairs of time and offset.
void McapWriter::put_message_indexes(ChunkIndex& index) {
  const std::uint64_t start = at_;
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    auto& entries = channels_[channel].in_chunk;
    if (entries.empty()) continue;
    std::ranges::stable_sort(entries, {}, [](const auto& entry) { return entry.first; });
    const auto id = static_cast<std::uint16_t>(channel);
    index.message_indexes.emplace_back(id, at_);
    content_.clear();
    LittleEndian to(content_);
    to.number(id);
    put_pairs(to, entries);
    put(op_message_index, content_);
    entries.clear();
  }
  index.indexes_length = at_ - start;
}

void McapWriter::put_chunk_index(const ChunkIndex& index) {
  content_.clear();
  LittleEndian to(content_);
  to.number(index.first_ns).number(index.last_ns).number(index.start).number(index.length);
  put_pairs(to, index.message_indexes);
  to.number(index.indexes_length).text("").number(index.size).number(index.size);
  put(op_chunk_index, content_);
}

void McapWriter::put_statistics() {
  std::uint64_t messages = 0, first = 0, last = 0;
  std::vector<std::pair<std::uint16_t, std::uint64_t>> counts;
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    messages += channels_[channel].messages;
    counts.emplace_back(static_cast<std::uint16_t>(channel), channels_[channel].messages);
  }
  for (const ChunkIndex& chunk : chunks_) {
    first = &chunk == chunks_.data() ? chunk.first_ns : std::min(first, chunk.first_ns);
    last = std::max(last, chunk.last_ns);
  }
  content_.clear();
  LittleEndian to(content_);
  to.number(messages)
      .number(static_cast<std::uint16_t>(schemas_.size()))
      .number(static_cast<std::uint32_t>(channels_.size()))
      .number(std::uint32_t{0})  // attachments
      .number(static_cast<std::uint32_t>(metadata_.size()))
      .number(static_cast<std::uint32_t>(chunks_.size()))
      .number(first)
      .number(last);
  put_pairs(to, counts);
  put(op_statistics, content_);
}

// The specification requires records of one kind to be contiguous.
void McapWriter::put_summary() {
  for (const Bytes& schema : schemas_) put(op_schema, schema);
  for (const Channel& channel : channels_) put(op_channel, channel.record);
  put_statistics();
  for (const ChunkIndex& chunk : chunks_) put_chunk_index(chunk);
  for (const MetadataIndex& entry : metadata_) {
    content_.clear();
    LittleEndian(content_).number(entry.start).number(entry.length).text(entry.name);
    put(op_metadata_index, content_);
  }
}

Result<void> McapWriter::written() const {
  if (write_error_ == 0) return {};
  return write_failure(path_, "write the recording", write_error_);
}

Result<std::string> McapWriter::finish() {
  if (path_.empty()) return std::string();
  end_chunk();
  content_.clear();
  LittleEndian(content_).number(crc_);  // of all so far: the data section
  put(op_data_end, content_);
  const std::uint64_t summary = at_;
  crc_ = 0;
  put_summary();
  // The CRC covers the summary and the footer up to itself.
  content_.clear();
  LittleEndian footer(content_);
  footer.number(summary).number(std::uint64_t{0});  // no offsets of the summary's parts
  Bytes head;
  LittleEndian(head).number(std::uint8_t{op_footer}).number(std::uint64_t{20});
  footer.number(crc_of(content_, crc_of(head, crc_)));
  put(op_footer, content_);
  put_bytes(kMagic);
  if (write_error_ == 0) errno = 0;
  file_.close();
  if (!file_)
    return write_failure(path_, "finish the recording", write_error_ ? write_error_ : errno);
  std::array<std::uint8_t, 32> digest{};
  EVP_DigestFinal_ex(digest_, digest.data(), nullptr);
  return hex_text(digest);
}

}  // namespace kaz::sim
