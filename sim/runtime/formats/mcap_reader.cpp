// Reads MCAP files record by record.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/mcap_reader.h"

#include <lz4frame.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>

#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"
#include "sim/runtime/formats/little_endian.h"

namespace kaz::sim {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t kHeadSize = 9;  // opcode and length

enum Opcode : std::uint8_t {
  op_invalid = 0x00,
  op_header = 0x01,
  op_footer = 0x02,
  op_schema = 0x03,
  op_channel = 0x04,
  op_message = 0x05,
  op_chunk = 0x06,
  op_metadata = 0x0C,
  op_data_end = 0x0F,
};

using Bytes = LittleEndianFields::Bytes;
using Fields = LittleEndianFields;

struct Record {
  std::uint8_t opcode = 0;
  std::uint64_t length = 0;  // of the content, as its head claims
};

Record head_of(Bytes bytes) {
  Fields head(bytes);
  const auto opcode = head.number<std::uint8_t>();
  return {opcode, head.number<std::uint64_t>()};
}

// Decompresses one LZ4 frame. Returns whether it ends with `from` and fills `to`.
bool decompress_lz4(Bytes from, std::span<std::uint8_t> to) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) return false;
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      made, &LZ4F_freeDecompressionContext);
  for (std::size_t missing = 1; missing != 0;) {
    std::size_t written = to.size(), consumed = from.size();
    missing = LZ4F_decompress(made, to.data(), &written, from.data(), &consumed, nullptr);
    if (LZ4F_isError(missing) || (written == 0 && consumed == 0)) return false;
    to = to.subspan(written);
    from = from.subspan(consumed);
  }
  return to.empty() && from.empty();
}

// Decompresses one zstd frame. Returns whether it ends with `from` and fills `to`. The library would also
// decompress its formats before 1.0, and several frames.
bool decompress_zstd(Bytes from, std::span<std::uint8_t> to) {
  if (Fields(from).number<std::uint32_t>() != ZSTD_MAGICNUMBER) return false;
  if (ZSTD_findFrameCompressedSize(from.data(), from.size()) != from.size()) return false;
  return ZSTD_decompress(to.data(), to.size(), from.data(), from.size()) == to.size();
}

// Later versions of the format may add fields at the end of all records but messages. They are ignored.
class Loader {
 public:
  Loader(McapRecording& to, Bytes file, const std::string& name)
      : to_(to), file_(file), name_(name) {}

  // The data section: records up to the data end or the truncation. The summary behind it is redundant.
  Result<void> load() {
    for (std::size_t at = kMagic.size(); file_.size() - at >= kHeadSize;) {
      const Bytes rest = file_.subspan(at);
      const Record record = head_of(rest);
      record_at_ = at;
      if ((record.opcode == op_header) != (at == kMagic.size()))
        return malformed("the header is missing or not the first record");
      // The last record of a truncated file may end beyond it, but not by more than a file can hold.
      if (record.length > McapRecording::kMaxBytes)
        return malformed("a record of " + std::to_string(record.length) + " bytes is too long");
      if (record.length > rest.size() - kHeadSize) return {};
      const auto length = static_cast<std::size_t>(record.length);
      const Bytes content = rest.subspan(kHeadSize, length);
      if (record.opcode == op_data_end) return data_end(content);
      if (auto done = top_level(record.opcode, content); !done) return done;
      at += kHeadSize + length;
    }
    return {};
  }

 private:
  tl::unexpected<Error> malformed(const std::string& what) const {
    return fail(Fault::usage, name_ + ": malformed at byte " + std::to_string(record_at_) + ": " +
                                  what + "; record the run again");
  }
  tl::unexpected<Error> too_short(const char* record) const {
    return malformed(std::string("the fields of a ") + record + " do not match its length");
  }

  tl::unexpected<Error> too_many_facts() const {
    return fail(Fault::usage, name_ + ": has more than the maximum of " +
                                  std::to_string(McapRecording::kMaxFacts) +
                                  " metadata entries; give a file with fewer");
  }

  Result<void> top_level(std::uint8_t opcode, Bytes content) {
    switch (opcode) {
      case op_invalid:
        return malformed("a record has type 0");
      case op_footer:
        return malformed("the footer comes before the end of the data");
      case op_chunk:
        return chunk(content);
      case op_metadata:
        return metadata(content);
      case op_schema:
      case op_channel:
      case op_message:
        return datum(opcode, content);
      default:  // indexes, attachments, private records: to be skipped by the specification
        return {};
    }
  }

  // Records in chunks or between them.
  Result<void> datum(std::uint8_t opcode, Bytes content) {
    if (opcode == op_schema) return schema(content);
    if (opcode == op_channel) return channel(content);
    return message(content);
  }

  Result<void> schema(Bytes content) {
    Fields fields(content);
    const auto id = fields.number<std::uint16_t>();
    McapRecording::Schema schema;
    schema.name = fields.text();
    schema.encoding = fields.text();
    schema.text = fields.text();
    if (!fields.good()) return too_short("schema");
    if (id == 0) return {};  // invalid, and to be ignored by the specification
    const auto [known, added] = to_.schemas.try_emplace(id, schema);
    if (!added && known->second != schema)
      return malformed("schema " + std::to_string(id) + " is defined twice");
    return {};
  }

  Result<void> channel(Bytes content) {
    Fields fields(content);
    const auto id = fields.number<std::uint16_t>();
    McapRecording::Encoding encoding;
    encoding.schema = fields.number<std::uint16_t>();
    const std::string topic = fields.text();
    encoding.message = fields.text();
    fields.array();  // metadata
    if (!fields.good()) return too_short("channel");
    const auto known = to_.topics.try_emplace(id, topic).first;
    if (to_.encodings.try_emplace(id, encoding).first->second != encoding || known->second != topic)
      return malformed("channel " + std::to_string(id) + " is defined twice");
    return {};
  }

  Result<void> message(Bytes content) {
    Fields fields(content);
    McapRecording::Message message;
    message.channel = fields.number<std::uint16_t>();
    fields.number<std::uint32_t>();  // sequence
    message.time_ns = fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();  // when it was published
    if (!fields.good()) return too_short("message");
    if (!to_.topics.contains(message.channel))
      return malformed("a message belongs to channel " + std::to_string(message.channel) +
                       ", which is not defined");
    if (message.time_ns < first_ns_ || message.time_ns > last_ns_)
      return malformed("the time of a message is outside its chunk's range");
    message.data.assign(fields.rest().begin(), fields.rest().end());
    to_.messages.push_back(std::move(message));
    return {};
  }

  Result<void> metadata(Bytes content) {
    Fields fields(content);
    const std::string name = fields.text();
    Fields map(fields.array());
    if (!fields.good()) return too_short("metadata record");
    std::map<std::string, std::string> entries;
    while (map.good() && !map.rest().empty()) {
      const std::string key = map.text();
      const std::string value = map.text();
      if (!map.good()) return malformed("metadata entries do not match their length");
      if (!entries.try_emplace(key, value).second)
        return malformed("a metadata entry occurs twice");
      if (entries.size() > McapRecording::kMaxFacts) return too_many_facts();
    }
    // rosbag2 writes a record when it opens the file, and the same record again when it closes the file.
    for (auto& [key, value] : entries) to_.facts.insert_or_assign(key, std::move(value));
    if (to_.facts.size() > McapRecording::kMaxFacts) return too_many_facts();
    to_.has_kaz_metadata = to_.has_kaz_metadata || name == "kaz";
    return {};
  }

  Result<void> chunk(Bytes content) {
    Fields fields(content);
    const auto first = fields.number<std::uint64_t>();
    const auto last = fields.number<std::uint64_t>();
    const auto uncompressed = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const std::string compression = fields.text();
    const auto size = fields.number<std::uint64_t>();
    Bytes inside = fields.take(size);
    if (!fields.good()) return too_short("chunk");
    if (first > last) return malformed("a chunk ends before it begins");
    std::vector<std::uint8_t> decompressed;
    if (compression.empty()) {
      if (uncompressed != size) return malformed("the two sizes of a chunk differ");
    } else {
      KAZ_TRY(decompress(compression, inside, uncompressed, decompressed));
      inside = decompressed;
    }
    if (crc != 0 && crc32_z(0, inside.data(), inside.size()) != crc) {
      ++to_.damaged_chunks;
      return {};
    }
    first_ns_ = first;
    last_ns_ = last;
    auto done = chunk_content(inside);
    first_ns_ = 0;
    last_ns_ = ~std::uint64_t{0};
    return done;
  }

  Result<void> decompress(const std::string& compression, Bytes from, std::uint64_t size,
                          std::vector<std::uint8_t>& to) {
    if (compression != "lz4" && compression != "zstd")
      return fail(Fault::usage, name_ + ": the compression `" + cut_text(one_line(compression)) +
                                    "` is unknown; give a file with compression lz4, zstd or none");
    if (size > McapRecording::kMaxChunkBytes)
      return fail(Fault::usage, name_ + ": a chunk of " + std::to_string(size) +
                                    " bytes is larger than the maximum of " +
                                    std::to_string(McapRecording::kMaxChunkBytes >> 20) +
                                    " MiB; give a file with smaller chunks");
    decompressed_bytes_ += size;
    if (decompressed_bytes_ > McapRecording::kMaxBytes)
      return fail(Fault::usage,
                  name_ + ": its decompressed chunks are larger than the maximum of " +
                      std::to_string(McapRecording::kMaxBytes >> 30) + " GiB; give a shorter file");
    if (from.empty() && size == 0) return {};
    to.resize(static_cast<std::size_t>(size));
    if (!(compression == "lz4" ? decompress_lz4(from, to) : decompress_zstd(from, to)))
      return malformed("the " + compression + " data of a chunk is damaged, or is not " +
                       std::to_string(size) + " bytes long");
    return {};
  }

  Result<void> chunk_content(Bytes inside) {
    while (!inside.empty()) {
      if (inside.size() < kHeadSize) return malformed("a chunk ends within a record");
      const Record record = head_of(inside);
      if (record.length > inside.size() - kHeadSize)
        return malformed("a chunk ends within a record");
      if (record.opcode != op_schema && record.opcode != op_channel && record.opcode != op_message)
        return malformed("a chunk contains a record of type " + std::to_string(record.opcode));
      const auto length = static_cast<std::size_t>(record.length);
      if (auto done = datum(record.opcode, inside.subspan(kHeadSize, length)); !done) return done;
      inside = inside.subspan(kHeadSize + length);
    }
    return {};
  }

  Result<void> data_end(Bytes content) {
    Fields fields(content);
    const auto crc = fields.number<std::uint32_t>();
    if (!fields.good()) return too_short("data end");
    // Damaged chunks were counted before.
    if (crc != 0 && to_.damaged_chunks == 0 && crc32_z(0, file_.data(), record_at_) != crc)
      return malformed("the checksum of the data is wrong");
    to_.whole = true;
    return {};
  }

  McapRecording& to_;
  Bytes file_;
  const std::string& name_;
  std::size_t record_at_ = 0;             // of the top-level record, in the file
  std::uint64_t decompressed_bytes_ = 0;  // of all compressed chunks
  std::uint64_t first_ns_ = 0, last_ns_ = ~std::uint64_t{0};  // of the chunk, if in one
};

bool has_magic(Bytes bytes) {
  return bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

tl::unexpected<Error> no_mcap(const std::string& name) {
  return fail(Fault::usage, name + ": not an MCAP file; give a recording.mcap written by kaz");
}

tl::unexpected<Error> too_large(const std::string& name) {
  return fail(Fault::usage, name + ": is larger than the maximum of " +
                                std::to_string(McapRecording::kMaxBytes >> 30) +
                                " GiB; record a shorter run");
}

}  // namespace

std::size_t McapRecording::count(const std::string& topic) const {
  return static_cast<std::size_t>(std::ranges::count_if(messages, [&](const Message& message) {
    const auto found = topics.find(message.channel);
    return found != topics.end() && found->second == topic;
  }));
}

std::string McapRecording::interrupted_by() const {
  const auto found = facts.find(kInterrupted);
  return found == facts.end() ? std::string() : found->second;
}

std::uint64_t McapRecording::end_ns() const {
  std::uint64_t end = 0;
  for (const Message& message : messages) end = std::max(end, message.time_ns);
  return end;
}

std::uint64_t McapRecording::duration_ns() const {
  const std::uint64_t end = end_ns();
  std::uint64_t begin = has_kaz_metadata ? 0 : end;
  for (const Message& message : messages) begin = std::min(begin, message.time_ns);
  return end - begin;
}

Result<void> McapRecording::check_run(const std::string& name) const {
  if (!has_kaz_metadata && (whole || !messages.empty()))
    return fail(Fault::usage, name +
                                  ": is an MCAP file of another program, and this command needs a "
                                  "recording of Kaz; give a recording.mcap written by kaz");
  if (const std::uint64_t end = end_ns(); end > kMaxTime_ns)
    return fail(Fault::usage, name + ": the time of a message is " + std::to_string(end) +
                                  " ns, more than a year after the start; record the run again");
  return {};
}

Result<McapRecording> McapRecording::parse(Bytes bytes, const std::string& name) {
  if (bytes.size() > kMaxBytes) return too_large(name);
  if (!has_magic(bytes)) return no_mcap(name);
  McapRecording recording;
  KAZ_TRY(Loader(recording, bytes, name).load());
  return recording;
}

Result<McapRecording> McapRecording::load(const std::string& path) {
  const auto file = KAZ_TRY(open_input(path, "give a recording"));
  std::error_code no_size;
  const auto size = std::filesystem::file_size(path, no_size);
  if (!no_size && size > kMaxBytes) return too_large(path);
  std::vector<std::uint8_t> bytes;
  if (!no_size) bytes.reserve(size);
  // In blocks: a file that is not MCAP is not read to its end.
  std::vector<std::uint8_t> block(1 << 20);
  for (;;) {
    const ssize_t n = ::read(file.get(), block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      return fail(Fault::usage,
                  path + ": cannot be read (" + std::strerror(errno) + "); give a recording");
    if (n == 0) break;
    bytes.insert(bytes.end(), block.begin(), block.begin() + n);
    if (!has_magic(bytes)) return no_mcap(path);
    if (bytes.size() > kMaxBytes) return too_large(path);
  }
  return parse(bytes, path);
}

Result<McapRecording> McapRecording::load_run(const std::string& path) {
  auto recording = KAZ_TRY(load(path));
  KAZ_TRY(recording.check_run(path));
  return recording;
}

}  // namespace kaz::sim
