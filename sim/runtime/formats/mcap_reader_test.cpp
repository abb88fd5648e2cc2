// Files of other programs: compressed chunks, times since 1970, and hostile sizes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/mcap_reader.h"

#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <string>
#include <vector>

#include "sim/runtime/formats/little_endian.h"

namespace kaz::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kIn2024_ns = 1'700'000'000'000'000'000;

Bytes operator+(Bytes front, const Bytes& back) {
  front.insert(front.end(), back.begin(), back.end());
  return front;
}

Bytes record(std::uint8_t opcode, const Bytes& content) {
  Bytes bytes{opcode};
  LittleEndian(bytes).number(std::uint64_t{content.size()}).bytes(content);
  return bytes;
}

Bytes schema(const std::string& text = "float64 data") {
  Bytes bytes;
  LittleEndian(bytes).number(std::uint16_t{1}).text("std_msgs/Float64").text("ros1msg").text(text);
  return record(0x03, bytes);
}

Bytes channel(std::uint16_t number, const std::string& topic, std::uint16_t schema = 1) {
  Bytes bytes;
  LittleEndian(bytes).number(number).number(schema).text(topic).text("ros1").text("");
  return record(0x04, bytes);
}

Bytes message(std::uint16_t channel, std::uint64_t time_ns, const Bytes& data) {
  Bytes bytes;
  LittleEndian(bytes)
      .number(channel)
      .number(std::uint32_t{0})
      .number(time_ns)
      .number(time_ns)
      .bytes(data);
  return record(0x05, bytes);
}

Bytes metadata(const std::string& name, const std::string& value) {
  Bytes entry, bytes;
  LittleEndian(entry).text("key").text(value);
  LittleEndian(bytes).text(name).number(static_cast<std::uint32_t>(entry.size())).bytes(entry);
  return record(0x0C, bytes);
}

// Chunk of messages of any time. `data` is its compressed content, and `size` its stated size before
// compression.
Bytes chunk(const std::string& compression, const Bytes& data, std::uint64_t size,
            std::uint32_t crc = 0) {
  Bytes bytes;
  LittleEndian(bytes)
      .number(std::uint64_t{0})
      .number(~std::uint64_t{0})
      .number(size)
      .number(crc)
      .text(compression)
      .number(std::uint64_t{data.size()})
      .bytes(data);
  return record(0x06, bytes);
}

Bytes lz4(const Bytes& content) {
  Bytes data(LZ4F_compressFrameBound(content.size(), nullptr));
  data.resize(
      LZ4F_compressFrame(data.data(), data.size(), content.data(), content.size(), nullptr));
  return data;
}

Bytes zstd(const Bytes& content) {
  Bytes data(ZSTD_compressBound(content.size()));
  data.resize(ZSTD_compress(data.data(), data.size(), content.data(), content.size(), 1));
  return data;
}

std::uint32_t crc_of(const Bytes& content) {
  return static_cast<std::uint32_t>(crc32_z(0, content.data(), content.size()));
}

// A whole file with these records.
Bytes mcap(const Bytes& records) {
  Bytes header;
  LittleEndian(header).text("ros1").text("another program");
  return Bytes{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'} + record(0x01, header) + records +
         record(0x0F, Bytes(4));
}

std::string refusal(const Bytes& file) {
  const auto read = McapRecording::parse(file, "a.mcap");
  if (read) return "";
  EXPECT_EQ(read.error().fault, Fault::usage);
  return read.error().message;
}

// Two messages of one topic, 2.5 s apart.
Bytes content() {
  return schema() + channel(1, "/x") + message(1, kIn2024_ns, Bytes(8, 1)) +
         message(1, kIn2024_ns + 2'500'000'000, Bytes(1000, 2));
}

void expect_content(const Bytes& file) {
  const auto read = McapRecording::parse(file, "a.mcap");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->whole);
  EXPECT_EQ(read->damaged_chunks, 0u);
  ASSERT_EQ(read->messages.size(), 2u);
  EXPECT_EQ(read->messages[0].time_ns, kIn2024_ns);
  EXPECT_EQ(read->messages[0].data, Bytes(8, 1));
  EXPECT_EQ(read->messages[1].data, Bytes(1000, 2));
  EXPECT_EQ(read->duration_ns(), 2'500'000'000u);
  EXPECT_EQ(read->topics, (std::map<std::uint16_t, std::string>{{1, "/x"}}));
  EXPECT_EQ(read->encodings.at(1), (McapRecording::Encoding{"ros1", 1}));
  EXPECT_EQ(read->schemas.at(1),
            (McapRecording::Schema{"std_msgs/Float64", "ros1msg", "float64 data"}));
}

TEST(McapReader, ReadsEachCompression) {
  const Bytes inside = content();
  ASSERT_LT(lz4(inside).size(), inside.size());
  expect_content(mcap(inside));
  expect_content(mcap(chunk("", inside, inside.size(), crc_of(inside))));
  expect_content(mcap(chunk("lz4", lz4(inside), inside.size(), crc_of(inside))));
  expect_content(mcap(chunk("zstd", zstd(inside), inside.size(), crc_of(inside))));
  const Bytes empty;
  for (const std::string compression : {"", "lz4", "zstd"})
    EXPECT_EQ(refusal(mcap(chunk(compression, empty, 0))), "") << compression;
  EXPECT_EQ(refusal(mcap(chunk("lz4", lz4(empty), 0) + chunk("zstd", zstd(empty), 0))), "");
}

// Larger than the blocks of both formats, with data that hardly shrinks.
TEST(McapReader, ReadsChunksOfManyBlocks) {
  Bytes noise(10 << 20);
  std::uint32_t state = 1;
  for (std::uint8_t& byte : noise) {
    state = state * 1664525 + 1013904223;
    byte = static_cast<std::uint8_t>(state >> 24);
  }
  const Bytes inside = schema() + channel(1, "/x") + message(1, 5, noise);
  for (const auto& [compression, data] :
       {std::pair{"lz4", lz4(inside)}, std::pair{"zstd", zstd(inside)}}) {
    const auto read = McapRecording::parse(mcap(chunk(compression, data, inside.size())), "a.mcap");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->messages.size(), 1u);
    EXPECT_EQ(read->messages[0].data, noise);
  }
}

TEST(McapReader, CompressedChunksHaveTheStatedSize) {
  const Bytes inside = content();
  for (const auto& [compression, data] :
       {std::pair{"lz4", lz4(inside)}, std::pair{"zstd", zstd(inside)}}) {
    SCOPED_TRACE(compression);
    const std::string wrong = std::string("the ") + compression + " data of a chunk is damaged";
    for (const std::size_t size : {std::size_t{0}, inside.size() - 1, inside.size() + 1,
                                   std::size_t{McapRecording::kMaxChunkBytes}})
      EXPECT_NE(refusal(mcap(chunk(compression, data, size))).find(wrong), std::string::npos)
          << size;
    for (std::size_t size = 0; size < data.size(); ++size) {
      const Bytes front(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_NE(refusal(mcap(chunk(compression, front, inside.size()))).find(wrong),
                std::string::npos)
          << size;
    }
    // One frame only, also if the second frame is empty or is skippable.
    const Bytes skippable{0x50, 0x2A, 0x4D, 0x18, 0, 0, 0, 0};
    for (const Bytes& more : {data, lz4({}), zstd({}), skippable, Bytes{0}})
      EXPECT_NE(refusal(mcap(chunk(compression, data + more, inside.size()))).find(wrong),
                std::string::npos);
    EXPECT_NE(refusal(mcap(chunk(compression, skippable + data, inside.size()))).find(wrong),
              std::string::npos);
  }
}

TEST(McapReader, ChangedBitsOfCompressedChunksAreNoticed) {
  const Bytes inside = content();
  for (const auto& [compression, data] :
       {std::pair{"lz4", lz4(inside)}, std::pair{"zstd", zstd(inside)}}) {
    for (std::size_t bit = 0; bit < 8 * data.size(); ++bit) {
      Bytes flipped = data;
      flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1 << bit % 8));
      const auto read = McapRecording::parse(
          mcap(chunk(compression, flipped, inside.size(), crc_of(inside))), "a.mcap");
      // A bit that the format ignores does not change the content.
      if (read && read->damaged_chunks == 0) {
        EXPECT_EQ(read->messages.size(), 2u) << compression << bit;
      }
    }
  }
}

TEST(McapReader, LimitsAreCheckedBeforeMemoryIsReserved) {
  const Bytes data = lz4(content());
  for (const std::uint64_t size :
       {McapRecording::kMaxChunkBytes + 1, std::uint64_t{1} << 40, ~std::uint64_t{0}})
    EXPECT_EQ(refusal(mcap(chunk("lz4", data, size))),
              "a.mcap: a chunk of " + std::to_string(size) +
                  " bytes is larger than the maximum of 256 MiB; give a file with smaller chunks");
  // Many chunks of the allowed size, each of a few kilobytes.
  const Bytes zeros(McapRecording::kMaxChunkBytes);
  const Bytes large = chunk("zstd", zstd(zeros), zeros.size(), 1);  // a wrong CRC: it is skipped
  Bytes all;
  for (std::uint64_t sum = 0; sum <= McapRecording::kMaxBytes; sum += zeros.size())
    all = all + large;
  EXPECT_LT(all.size(), 1u << 20);
  EXPECT_EQ(
      refusal(mcap(all)),
      "a.mcap: its decompressed chunks are larger than the maximum of 2 GiB; give a shorter file");
}

TEST(McapReader, UnknownCompressionsAreNamed) {
  EXPECT_EQ(refusal(mcap(chunk("bz2\n", {1, 2}, 10))),
            "a.mcap: the compression `bz2 ` is unknown; give a file with compression lz4, zstd or "
            "none");
}

TEST(McapReader, RecordsOfAnotherProgramAreNoRun) {
  const auto refused = [&](const Bytes& file) -> std::string {
    const auto read = McapRecording::parse(file, "a.mcap");
    EXPECT_TRUE(read);
    const auto is_run = read ? read->check_run("a.mcap") : Result<void>();
    return is_run ? "" : is_run.error().message;
  };
  const std::string another =
      "a.mcap: is an MCAP file of another program, and this command needs a recording of Kaz; give "
      "a "
      "recording.mcap written by kaz";
  EXPECT_EQ(refused(mcap(content())), another);
  EXPECT_EQ(refused(mcap({})), another);
  const Bytes soon = schema() + channel(1, "/x") + message(1, 7, {});
  EXPECT_EQ(refused(mcap(metadata("rosbag2", "") + soon)), another);
  EXPECT_EQ(refused(mcap(metadata("kaz", "") + soon)), "");
  EXPECT_EQ(
      refused(mcap(metadata("kaz", "") + content())),
      "a.mcap: the time of a message is 1700000002500000000 ns, more than a year after the start; "
      "record the run again");
  // Without any message, the command says what is missing.
  Bytes cut_off = mcap({});
  cut_off.resize(20);
  EXPECT_EQ(refused(cut_off), "");
}

TEST(McapReader, ARecordingOfKazBeginsAtZero) {
  const Bytes later = schema() + channel(1, "/x") + message(1, 40, {}) + message(1, 30, {});
  const auto own = McapRecording::parse(mcap(metadata("kaz", "") + later), "a.mcap");
  ASSERT_TRUE(own);
  EXPECT_EQ(own->duration_ns(), 40u);
  const auto other = McapRecording::parse(mcap(later), "a.mcap");
  ASSERT_TRUE(other);
  EXPECT_EQ(other->duration_ns(), 10u);
  const auto none = McapRecording::parse(mcap({}), "a.mcap");
  ASSERT_TRUE(none);
  EXPECT_EQ(none->duration_ns(), 0u);
}

// As in files of rosbag2, and of writers that repeat schemas and channels in each chunk.
TEST(McapReader, RepeatedRecordsMayAgree) {
  const auto read = McapRecording::parse(
      mcap(metadata("rosbag2", "1") + content() + content() + metadata("rosbag2", "2")), "a.mcap");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->facts.at("key"), "2");
  EXPECT_EQ(read->messages.size(), 4u);
  EXPECT_NE(refusal(mcap(schema() + schema("int8 a"))).find("schema 1 is defined twice"),
            std::string::npos);
  for (const Bytes& again : {channel(1, "/y"), channel(1, "/x", 2)})
    EXPECT_NE(refusal(mcap(content() + again)).find("channel 1 is defined twice"),
              std::string::npos);
}

// The specification lets later versions add fields at the end of a record.
TEST(McapReader, UnknownFieldsAreIgnored) {
  const auto longer = [](Bytes bytes) {
    bytes[1] = static_cast<std::uint8_t>(bytes[1] + 2);  // the lowest byte of the length
    return bytes + Bytes{7, 8};
  };
  const Bytes inside = longer(schema()) + longer(channel(1, "/x")) + message(1, 5, {1});
  Bytes no_schema = schema();
  no_schema[9] = 0;  // the number 0 is invalid, and to be ignored
  Bytes file = mcap(longer(chunk("", inside, inside.size(), crc_of(inside))) +
                    longer(metadata("a", "b")) + no_schema);
  file.resize(file.size() - record(0x0F, Bytes(4)).size());
  const auto read = McapRecording::parse(file + record(0x0F, Bytes(6)), "a.mcap");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->whole);
  ASSERT_EQ(read->messages.size(), 1u);
  EXPECT_EQ(read->messages[0].data, Bytes{1});
  EXPECT_EQ(read->facts.at("key"), "b");
  EXPECT_EQ(read->schemas.size(), 1u);
}

}  // namespace
}  // namespace kaz::sim
