// Reads MCAP files record by record.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/mcap_reader.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>

#include "sim/runtime/little_endian.h"

namespace kaz::sim {
namespace {

constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t head_size = 9;  // opcode and length

using Bytes = LittleEndianFields::Bytes;
using Fields = LittleEndianFields;

class Loader {
 public:
  Loader(McapRecording& to, std::string path) : to_(to), path_(std::move(path)) {}

  Result<void> records(Bytes bytes) {
    while (bytes.size() >= head_size) {
      Fields head(bytes);
      const auto opcode = head.number<std::uint8_t>();
      const auto length = head.number<std::uint64_t>();
      if (length > bytes.size() - head_size) return {};  // the writer died here
      if (auto done = record(opcode, bytes.subspan(head_size, length)); !done) return done;
      if (opcode == 0x0F) {  // what follows repeats
        to_.whole = true;
        return {};
      }
      bytes = bytes.subspan(head_size + length);
    }
    return {};
  }

 private:
  Result<void> record(std::uint8_t opcode, Bytes content) {
    Fields fields(content);
    switch (opcode) {
      case 0x04: {
        const auto id = fields.number<std::uint16_t>();
        fields.number<std::uint16_t>();
        to_.topics[id] = fields.text();
        return {};
      }
      case 0x05: {
        McapRecording::Message message;
        message.channel = fields.number<std::uint16_t>();
        fields.number<std::uint32_t>();
        message.time_ns = fields.number<std::uint64_t>();
        fields.number<std::uint64_t>();
        message.data.assign(fields.rest().begin(), fields.rest().end());
        to_.messages.push_back(std::move(message));
        return {};
      }
      case 0x06:
        return chunk(fields);
      case 0x0C: {
        fields.text();
        Fields map(fields.take(fields.number<std::uint32_t>()));
        while (!map.rest().empty()) {
          const std::string key = map.text();
          to_.facts[key] = map.text();
        }
        return {};
      }
      default:
        return {};
    }
  }

  Result<void> chunk(Fields fields) {
    fields.take(16);
    fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    if (const std::string compression = fields.text(); !compression.empty())
      return fail(Fault::usage, path_ + ": its chunks are compressed (" + compression +
                                    "); give a recording that kaz has made");
    const Bytes inside = fields.take(fields.number<std::uint64_t>());
    if (crc != 0 && crc32_z(0, inside.data(), inside.size()) != crc) {
      ++to_.damaged_chunks;
      return {};
    }
    return records(inside);
  }

  McapRecording& to_;
  std::string path_;
};

}  // namespace

bool McapRecording::has_messages(const std::string& topic) const {
  return std::ranges::any_of(messages, [&](const Message& message) {
    const auto found = topics.find(message.channel);
    return found != topics.end() && found->second == topic;
  });
}

Result<McapRecording> McapRecording::load(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return fail(Fault::usage, "cannot read the recording " + path + ": " + std::strerror(errno) +
                                  "; check the path");
  const std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(file), {});
  if (bytes.size() < magic.size() || !std::equal(magic.begin(), magic.end(), bytes.begin()))
    return fail(Fault::usage, path + ": this is no MCAP file; give a recording.mcap of kaz");
  McapRecording recording;
  Loader loader(recording, path);
  if (auto done = loader.records(Bytes(bytes).subspan(magic.size())); !done)
    return tl::unexpected(done.error());
  return recording;
}

}  // namespace kaz::sim
