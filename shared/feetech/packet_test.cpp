// Packets against the examples of the public manuals (corpus/packets.json), and against damage.
// SPDX-License-Identifier: Apache-2.0
#include "shared/feetech/packet.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared/base/hex_text.hpp"
#include "shared/base/random.hpp"

namespace kaz::feetech {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const std::string& hex) {
  std::istringstream words(hex);
  Bytes bytes;
  for (unsigned byte; words >> std::hex >> byte;) bytes.push_back(static_cast<std::uint8_t>(byte));
  return bytes;
}

// All packets in the bytes, by the reader.
std::vector<Packet> packets_in(const Bytes& bytes, PacketReader& reader) {
  std::vector<Packet> packets;
  for (const std::uint8_t byte : bytes) {
    if (reader.take(byte) == PacketReader::Event::packet) packets.push_back(reader.packet());
  }
  return packets;
}

TEST(Packet, ExamplesOfTheManualsAreReadAndWrittenBack) {
  std::ifstream file("shared/feetech/corpus/packets.json");
  const auto corpus = nlohmann::json::parse(file);
  ASSERT_GE(corpus.size(), 24u);
  for (const auto& example : corpus) {
    std::vector<std::string> texts = example.at("answers");
    texts.push_back(example.at("request"));
    for (const std::string& text : texts) {
      const Bytes wire = bytes_of(text);
      PacketReader reader;
      const auto packets = packets_in(wire, reader);
      ASSERT_EQ(packets.size(), 1u) << example.at("name") << ": " << text;
      EXPECT_EQ(wire_of(packets[0]), wire) << example.at("name") << ": " << hex_text(wire, " ");
      EXPECT_EQ(packets[0].id, wire[2]);
      EXPECT_EQ(packets[0].code, wire[4]);
      EXPECT_EQ(reader.counts().skipped_bytes + reader.counts().bad(), 0u);
    }
  }
}

TEST(Packet, AnyOneDamagedByteIsSeen) {
  const Bytes good = wire_of(request(1, Instruction::write, {42, 0, 8, 0, 0, 0xE8, 3}));
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes wire = good;
      wire[at] ^= static_cast<std::uint8_t>(1 << bit);
      PacketReader reader;
      EXPECT_TRUE(packets_in(wire, reader).empty()) << at << " " << bit;
      reader.reset();
      EXPECT_GT(reader.counts().bad() + reader.counts().skipped_bytes, 0u) << at << " " << bit;
      // The next one is read, whatever the damage.
      EXPECT_EQ(packets_in(good, reader).size(), 1u) << at << " " << bit;
    }
  }
}

TEST(Packet, HeaderInNoiseIsFound) {
  PacketReader reader;
  Bytes wire{0x00, 0xFF, 0x12, 0xFF, 0xFF};  // three FF before the id
  const Bytes good = wire_of(request(3, Instruction::ping));
  wire.insert(wire.end(), good.begin(), good.end());
  ASSERT_EQ(packets_in(wire, reader).size(), 1u);
  EXPECT_EQ(reader.packet().id, 3);
  EXPECT_EQ(reader.counts().skipped_bytes, 5u);
}

TEST(Packet, ManyPacketsInARowAreAllFound) {
  Random random(5);
  PacketReader reader;
  for (int i = 0; i < 20000; ++i) {
    Packet packet{static_cast<std::uint8_t>(random.below(254)),
                  static_cast<std::uint8_t>(random.below(256)),
                  {}};
    packet.parameters.resize(random.below(40));
    for (auto& byte : packet.parameters) byte = static_cast<std::uint8_t>(random.below(256));
    const auto found = packets_in(wire_of(packet), reader);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0], packet);
  }
  EXPECT_EQ(reader.counts().skipped_bytes + reader.counts().bad(), 0u);
}

TEST(Packet, TooShortALengthIsRefused) {
  PacketReader reader;
  for (const int length : {0, 1}) {
    for (const std::uint8_t byte : {0xFF, 0xFF, 0x01}) (void)reader.take(byte);
    EXPECT_EQ(reader.take(static_cast<std::uint8_t>(length)), PacketReader::Event::bad_length);
  }
  EXPECT_EQ(reader.counts().bad_lengths, 2u);
}

}  // namespace
}  // namespace kaz::feetech
