// The recording's file format, read back by the letter of https://mcap.dev/spec.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <fstream>
#include <iterator>
#include <map>
#include <span>

#include "shared/base/files.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/formats/mcap_writer.h"
#include "sim/runtime/formats/png_picture.h"
#include "sim/runtime/formats/sha256.h"
#include "sim/runtime/simulation/recorder.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Reads numbers and strings from a record's content.
class Reader {
 public:
  explicit Reader(Bytes bytes) : bytes_(std::move(bytes)) {}
  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{bytes_.at(at_++)} << (8 * i);
    return value;
  }
  std::string text() {
    const auto size = number(4);
    std::string value(bytes_.begin() + at_, bytes_.begin() + at_ + size);
    at_ += size;
    return value;
  }
  Bytes rest() const { return {bytes_.begin() + at_, bytes_.end()}; }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

struct Record {
  int opcode;
  Bytes content;
};

const Bytes kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

std::vector<Record> records_of(const Bytes& file) {
  EXPECT_EQ(Bytes(file.begin(), file.begin() + 8), kMagic);
  EXPECT_EQ(Bytes(file.end() - 8, file.end()), kMagic);
  std::vector<Record> records;
  std::size_t at = 8;
  while (at < file.size() - 8) {
    Reader head(Bytes(file.begin() + at + 1, file.begin() + at + 9));
    const auto length = head.number(8);
    records.push_back({file[at], Bytes(file.begin() + at + 9, file.begin() + at + 9 + length)});
    at += 9 + length;
  }
  EXPECT_EQ(at, file.size() - 8);
  return records;
}

// Messages of each topic.
std::map<std::string, std::vector<Bytes>> messages_of(const std::string& path) {
  std::map<std::string, std::vector<Bytes>> messages;
  const auto recording = McapRecording::load(path);
  EXPECT_TRUE(recording) << recording.error().message;
  if (!recording) return messages;
  EXPECT_TRUE(recording->whole);
  EXPECT_EQ(recording->damaged_chunks, 0u);
  for (const auto& message : recording->messages)
    messages[recording->topics.at(message.channel)].push_back(message.data);
  return messages;
}

TEST(Sha256, OfAbc) {  // FIPS 180-2, appendix B.1
  EXPECT_EQ(sha256_hex(Bytes{'a', 'b', 'c'}),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(McapWriter, WritesRecordsInOrder) {
  const TestFolder folder;
  const std::string path = folder.file("a.mcap");
  auto writer = McapWriter::create(path, "kaz 1");
  ASSERT_TRUE(writer);
  (*writer)->add_metadata("facts", {{"seed", "1"}});
  const auto schema = (*writer)->add_schema("S", "ros1msg", "uint8 a\n");
  const auto channel = (*writer)->add_channel(schema, "/a", "ros1");
  (*writer)->add_message(channel, 5, Bytes{9});
  (*writer)->add_message(channel, 6, Bytes{10});
  const auto hash = (*writer)->finish();
  ASSERT_TRUE(hash);

  const Bytes file = contents(path);
  EXPECT_EQ(*hash, sha256_hex(file));
  const auto records = records_of(file);
  std::vector<int> opcodes;
  for (const Record& record : records) opcodes.push_back(record.opcode);
  EXPECT_EQ(opcodes, (std::vector<int>{0x01, 0x0C, 0x03, 0x04, 0x06, 0x07, 0x0F, 0x03, 0x04, 0x0B,
                                       0x08, 0x0D, 0x02}));

  Reader header(records[0].content);
  EXPECT_EQ(header.text(), "");
  EXPECT_EQ(header.text(), "kaz 1");
  Reader facts(records[1].content);
  EXPECT_EQ(facts.text(), "facts");
  EXPECT_EQ(facts.number(4), 4u + 4 + 4 + 1);
  EXPECT_EQ(facts.text(), "seed");
  EXPECT_EQ(facts.text(), "1");
  Reader made_schema(records[2].content);
  EXPECT_EQ(made_schema.number(2), schema);
  EXPECT_EQ(made_schema.text(), "S");
  EXPECT_EQ(made_schema.text(), "ros1msg");
  EXPECT_EQ(made_schema.text(), "uint8 a\n");
  const auto recording = McapRecording::load(path);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->facts.at("seed"), "1");
  ASSERT_EQ(recording->messages.size(), 2u);
  EXPECT_EQ(recording->topics.at(recording->messages[1].channel), "/a");
  EXPECT_EQ(recording->messages[1].time_ns, 6u);
  EXPECT_EQ(recording->messages[1].data, Bytes{10});
  Reader index(records[5].content);
  EXPECT_EQ(index.number(2), channel);
  EXPECT_EQ(index.number(4), 2u * 16);
  EXPECT_EQ(index.number(8), 5u);
  EXPECT_EQ(index.number(8), 0u);  // the first message stands at the chunk's start
}

// Three chunks, of which the second is damaged.
TEST(McapWriter, ADamagedFileLosesOneChunk) {
  const TestFolder folder;
  const std::string path = folder.file("a.mcap");
  auto writer = McapWriter::create(path, "kaz 1");
  ASSERT_TRUE(writer);
  const auto channel =
      (*writer)->add_channel((*writer)->add_schema("S", "ros1msg", "uint8 a\n"), "/a", "ros1");
  const Bytes half(McapWriter::kChunkBytes / 2, 7);  // so that two fill a chunk
  for (std::uint64_t k = 0; k < 6; ++k) (*writer)->add_message(channel, k, half);
  ASSERT_TRUE((*writer)->finish());
  {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(3 * static_cast<std::streamoff>(half.size()));
    file.put(8);
  }
  const auto recording = McapRecording::load(path);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->damaged_chunks, 1u);
  ASSERT_EQ(recording->messages.size(), 4u);
  EXPECT_EQ(recording->messages[1].time_ns, 1u);
  EXPECT_EQ(recording->messages[2].time_ns, 4u);
}

// Whatever byte a file ends at, it is read up to there: never an error, and never more than was written.
TEST(McapRecording, IsReadToWhereItWasCutOff) {
  const TestFolder folder;
  const std::string path = folder.file("a.mcap");
  auto writer = McapWriter::create(path, "kaz 1");
  ASSERT_TRUE(writer);
  (*writer)->add_metadata("facts", {{"seed", "1"}});
  const auto channel =
      (*writer)->add_channel((*writer)->add_schema("S", "ros1msg", "uint8 a\n"), "/a", "ros1");
  const Bytes half(McapWriter::kChunkBytes / 2, 7);  // so that two fill a chunk
  for (std::uint64_t k = 0; k < 4; ++k) (*writer)->add_message(channel, k, half);
  ASSERT_TRUE((*writer)->finish());
  const Bytes file = contents(path);
  std::size_t before = 0;
  for (std::size_t size = 8; size <= file.size(); size += size < 400 ? 1 : 4099) {
    const auto read = McapRecording::parse(std::span(file).first(size), "a");
    ASSERT_TRUE(read) << size << ": " << read.error().message;
    ASSERT_GE(read->messages.size(), before);
    ASSERT_EQ(read->messages.size() % 2, 0u) << "chunks come whole";
    before = read->messages.size();
    if (!read->whole) {
      ASSERT_LT(size, file.size());
    }
  }
  const auto whole = McapRecording::parse(file, "a");
  ASSERT_TRUE(whole);
  EXPECT_TRUE(whole->whole);
  EXPECT_EQ(whole->messages.size(), 4u);
  EXPECT_EQ(whole->end_ns(), 3u);
}

// Each bit of what stands outside of the chunks, flipped alone.
TEST(McapRecording, NoFlippedBitIsBelieved) {
  const TestFolder folder;
  const std::string path = folder.file("a.mcap");
  auto writer = McapWriter::create(path, "kaz 1");
  ASSERT_TRUE(writer);
  (*writer)->add_metadata("facts", {{"seed", "1"}, {"world", "ball"}});
  const auto channel =
      (*writer)->add_channel((*writer)->add_schema("S", "ros1msg", "uint8 a\n"), "/a", "ros1");
  for (std::uint64_t k = 0; k < 4; ++k) (*writer)->add_message(channel, k, Bytes{1, 2, 3});
  ASSERT_TRUE((*writer)->finish());
  const Bytes file = contents(path);
  const auto untouched = McapRecording::parse(file, "a");
  ASSERT_TRUE(untouched);
  for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
    Bytes flipped = file;
    flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1 << bit % 8));
    const auto read = McapRecording::parse(flipped, "a");
    if (!read) {
      EXPECT_EQ(read.error().message.rfind("a: ", 0), 0u) << read.error().message;
      EXPECT_EQ(read.error().fault, Fault::usage);
    } else if (read->whole && read->damaged_chunks == 0) {
      // The summary repeats, and is not read; a checksum of 0 means none, the bit being its only one.
      EXPECT_EQ(read->messages, untouched->messages) << bit;
      EXPECT_EQ(read->facts, untouched->facts) << bit;
      EXPECT_EQ(read->topics, untouched->topics) << bit;
    }
  }
}

TEST(McapWriter, SaysWhereItCannotWrite) {
  const auto writer = McapWriter::create("/nonexistent/a.mcap", "kaz");
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().fault, Fault::environment);
  EXPECT_NE(writer.error().message.find("/nonexistent/a.mcap"), std::string::npos);
}

TEST(McapWriter, NamesAFullDisk) {
  auto writer = McapWriter::create("/dev/full", "kaz");
  ASSERT_TRUE(writer);
  const auto schema = (*writer)->add_schema("kaz/Bytes", "ros1msg", "uint8[] data");
  const auto channel = (*writer)->add_channel(schema, "/a", "ros1");
  (*writer)->add_message(channel, 1, std::vector<std::uint8_t>(McapWriter::kChunkBytes));
  const auto finished = (*writer)->finish();
  ASSERT_FALSE(finished);
  EXPECT_TRUE(finished.error().disk_full) << finished.error().message;
  EXPECT_NE(finished.error().message.find("/dev/full"), std::string::npos);
}

TEST(Recorder, MessagesHaveTheSizeOfTheirSchema) {
  const TestFolder folder;
  const std::string path = folder.file("a.mcap");
  auto recorder = Recorder::create(path, {{"seed", "1"}});
  ASSERT_TRUE(recorder);
  const TestWorld world;
  const SerialByte bytes[] = {{1, 100, false}, {2, 1700, true}};
  (*recorder)->wire(Recorder::Direction::to_board, 0, bytes);
  (*recorder)->wire(Recorder::Direction::to_host, 0, {});
  (*recorder)->pins(18432, {});
  (*recorder)->analog(18432, {});
  (*recorder)->joints(18432, world.joints().first<KZ_JOINTS>());
  (*recorder)->ball(18432, {1, 2, 3});
  (*recorder)->supply(18432, 10, 1);
  const ContactPoint touch{"a", "bc", {1, 2, 3}, {4, 5, 6}};
  (*recorder)->contacts(18432, {&touch, 1});
  const std::string feet[] = {"abc", "de"};
  const LinkForce forces[] = {{}, {{1, 2, 3}, {4, 5, 6}, 3, {7, 8, 9}}};
  (*recorder)->link_forces(18432, feet, forces);
  (*recorder)->joint_loads(18432, std::array<JointLoad, KZ_JOINTS>{});
  Eyes::Digest pair{1, Time(1'000'000'005), Time(1'015'000'005), {}};
  pair.kept.left = std::string(64, 'a');
  pair.kept.right = std::string(64, 'b');
  (*recorder)->eyes(pair);
  pair.kept.left_png = {1, 2, 3};
  pair.kept.right_png = {4, 5};
  (*recorder)->eyes(pair);
  (*recorder)->behavior(18432, "{}");
  ASSERT_TRUE((*recorder)->finish());

  const auto messages = messages_of(path);
  EXPECT_EQ(messages.at("/wire/to_board").at(0),
            (Bytes{2, 0, 0, 0, 1, 2, 2, 0, 0, 0, 100, 0, 0xa4, 0x06, 2, 0, 0, 0, 0, 1}));
  EXPECT_EQ(messages.count("/wire/to_host"), 0u);  // nothing sent, nothing written
  EXPECT_EQ(messages.at("/board/pins").at(0).size(), 2u * 18 + 4);
  EXPECT_EQ(messages.at("/board/analog").at(0).size(), 4u + 2 * 24);
  EXPECT_EQ(messages.at("/truth/joints").at(0).size(), 8u * 54);
  EXPECT_EQ(messages.at("/truth/ball").at(0).size(), 24u);
  EXPECT_EQ(messages.at("/board/supply").at(0).size(), 16u);
  EXPECT_EQ(messages.at("/truth/contacts").at(0).size(), 4u + 4 + 1 + 4 + 2 + 48);
  // The first link touches nothing.
  EXPECT_EQ(messages.at("/truth/link_forces").at(0).size(), 4u + 4 + 2 + 8 * 10);
  EXPECT_EQ(messages.at("/truth/joint_loads").at(0).size(), 8u * 108);
  EXPECT_EQ(messages.at("/eyes").at(0).size(), 8u + 2 * (4 + 64));
  ASSERT_EQ(messages.at("/eyes/left").size(), 1u);  // the first pair was not kept
  Reader left(messages.at("/eyes/left").at(0));
  EXPECT_EQ(left.number(4), 1u);
  EXPECT_EQ(left.number(4), 1u);
  EXPECT_EQ(left.number(4), 5u);
  EXPECT_EQ(left.text(), "left_eye");
  EXPECT_EQ(left.text(), "png");
  EXPECT_EQ(left.number(4), 3u);
  EXPECT_EQ(left.rest(), (Bytes{1, 2, 3}));
  EXPECT_EQ(messages.at("/eyes/right").at(0).size(), 12u + 4 + 9 + 4 + 3 + 4 + 2);
  EXPECT_EQ(messages.at("/behavior").at(0), (Bytes{'{', '}'}));
}

TEST(Recorder, ContactsAreArrowsAlongTheirForce) {
  const TestFolder folder;
  const std::string path = folder.file("contacts.mcap");
  const auto recorder = Recorder::create(path, {});
  ASSERT_TRUE(recorder);
  const ContactPoint touches[] = {{"a", "b", {1, 2, 3}, {0, 0, 100}},
                                  {"a", "b", {4, 5, 6}, {0, 0.03, 0}},
                                  {"a", "b", {7, 8, 9}, {0, -2, 0}}};
  (*recorder)->contact_markers(18432, touches);
  ASSERT_TRUE((*recorder)->finish());
  const auto messages = messages_of(path);
  Reader read(messages.at("/contacts").at(0));
  struct Arrow {
    std::uint64_t action = 0;
    std::array<double, 3> at{}, along{}, scale{};
  };
  std::vector<Arrow> arrows(read.number(4));
  const auto real = [&read] { return std::bit_cast<double>(read.number(8)); };
  for (Arrow& arrow : arrows) {
    read.number(4), read.number(8);
    EXPECT_EQ(read.text(), "world");
    EXPECT_EQ(read.text(), "contacts");
    read.number(4);
    const auto type = read.number(4);
    arrow.action = read.number(4);
    EXPECT_EQ(type, arrow.action == 0 ? 0u : 1u);
    for (double& x : arrow.at) x = real();
    const double x = real(), y = real(), z = real(), w = real();
    // The rotation of the x axis.
    arrow.along = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
    for (double& x_scale : arrow.scale) x_scale = real();
    for (int i = 0; i < 4; ++i) read.number(4);
    read.number(8), read.number(1), read.number(8);
    read.text(), read.text(), read.number(1);
  }
  EXPECT_TRUE(read.rest().empty());
  ASSERT_EQ(arrows.size(), 3u);  // the second force is too small to be seen
  EXPECT_EQ(arrows[0].action, 3u);
  EXPECT_EQ(arrows[1].at, (std::array{1.0, 2.0, 3.0}));
  EXPECT_NEAR(arrows[1].along[2], 1, 1e-12);
  EXPECT_EQ(arrows[1].scale[0], 0.3);
  EXPECT_EQ(arrows[2].at, (std::array{7.0, 8.0, 9.0}));
  EXPECT_NEAR(arrows[2].along[1], -1, 1e-12);
  EXPECT_EQ(arrows[2].scale[0], 0.02);
}

// A second of life with a moving joint, eyes open.
std::string recorded(std::uint64_t seed, const std::string& path) {
  SimulationOptions options;
  options.seed = seed;
  options.recording_path = path;
  auto simulation = test_simulation(options);
  EXPECT_NE(simulation, nullptr);
  simulation->open_eyes();
  for (int t = 0; t < 1000; ++t) {
    if (t % 100 == 0) simulation->write(Bytes{0, 3, 1, 5, static_cast<std::uint8_t>(t), 0});
    EXPECT_TRUE(simulation->step());
    while (simulation->next_pair()) {
    }
  }
  simulation->record_behavior(R"({"state": "done"})");
  const auto hash = simulation->finish_recording();
  EXPECT_TRUE(hash);
  return hash.value_or("");
}

TEST(Recorder, SameSeedSameBytes) {
  const TestFolder folder;
  const std::string first = recorded(1, folder.file("1.mcap"));
  EXPECT_EQ(first, recorded(1, folder.file("2.mcap")));
  EXPECT_NE(first, recorded(2, folder.file("3.mcap")));
  EXPECT_EQ(contents(folder.file("1.mcap")), contents(folder.file("2.mcap")));
}

TEST(Recorder, HoldsEveryMillisecondAndEveryPicture) {
  const TestFolder folder;
  recorded(1, folder.file("1.mcap"));
  const auto messages = messages_of(folder.file("1.mcap"));
  EXPECT_EQ(messages.at("/board/pins").size(), 1000u);
  EXPECT_EQ(messages.at("/truth/joints").size(), 1000u);
  EXPECT_EQ(messages.at("/truth/ball").size(), 1000u);
  EXPECT_EQ(messages.at("/eyes").size(), 30u);  // exposures 1..30 of 30 a second
  EXPECT_EQ(messages.at("/behavior").size(), 1u);
  EXPECT_EQ(messages.at("/wire/to_board").size(), 10u);
}

TEST(Recorder, PicturesAreThoseOfTheHost) {
  const TestFolder folder;
  const std::string path = folder.file("1.mcap");
  SimulationOptions options;
  options.recording_path = path;
  options.record_pictures = true;
  auto simulation = test_simulation(options);
  ASSERT_NE(simulation, nullptr);
  simulation->open_eyes();
  struct Arrived {
    std::uint64_t sequence;
    Time exposure, at;
    vision::Image left, right;
  };
  std::vector<Arrived> arrived;
  for (int t = 0; t < 500; ++t) {
    ASSERT_TRUE(simulation->step());
    while (const auto pair = simulation->next_pair()) {
      const auto images = pair->images.get();
      arrived.push_back({pair->info.sequence, pair->info.exposure, simulation->time(), images->left,
                         images->right});
    }
  }
  ASSERT_TRUE(simulation->finish_recording());
  const auto recording = McapRecording::load(path);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->facts.at("camera").substr(0, 6), "32 24 ");
  std::map<std::string, std::size_t> seen;
  for (const auto& message : recording->messages) {
    const std::string& topic = recording->topics.at(message.channel);
    if (topic != "/eyes/left" && topic != "/eyes/right") continue;
    const std::size_t k = seen[topic]++;
    if (k == arrived.size()) continue;  // exposed, under way at the end
    Reader reader(message.data);
    EXPECT_EQ(reader.number(4), arrived[k].sequence);
    EXPECT_EQ(reader.number(4) * 1'000'000'000 + reader.number(4),
              static_cast<std::uint64_t>(arrived[k].exposure.count()));
    // The host queries at the end of the step in which the pair arrived.
    const auto late = arrived[k].at.count() - static_cast<std::int64_t>(message.time_ns);
    EXPECT_GE(late, 0);
    EXPECT_LT(late, 1'000'000);
    reader.text();
    reader.text();
    reader.number(4);
    const auto image = decode_png(reader.rest());
    ASSERT_TRUE(image) << image.error().message;
    const vision::Image& host = topic == "/eyes/left" ? arrived[k].left : arrived[k].right;
    EXPECT_EQ(image->width, host.width);
    EXPECT_EQ(image->height, host.height);
    EXPECT_EQ(image->rgb, host.rgb);
  }
  EXPECT_EQ(arrived.size(), 14u);
  EXPECT_GE(seen["/eyes/left"], arrived.size());
  EXPECT_EQ(seen["/eyes/left"], seen["/eyes/right"]);
}

TEST(PngPicture, ComesBackExactlyOrNotAtAll) {
  vision::Image image{31, 17, {}};
  for (int i = 0; i < 31 * 17 * 3; ++i) image.rgb.push_back(static_cast<std::uint8_t>(i * i / 7));
  auto bytes = encode_png(image);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(*bytes, encode_png(image).value());
  const auto back = decode_png(*bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->rgb, image.rgb);
  bytes->at(bytes->size() / 2) ^= 4;
  EXPECT_FALSE(decode_png(*bytes));
  bytes->resize(40);
  EXPECT_FALSE(decode_png(*bytes));
  EXPECT_FALSE(decode_png({}));
  EXPECT_FALSE(encode_png({2, 2, {1, 2, 3}}));
}

}  // namespace
}  // namespace kaz::sim
