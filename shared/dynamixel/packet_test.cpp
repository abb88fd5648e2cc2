// Packets against the examples of the public manual (corpus/packets.json), and against damage.
// SPDX-License-Identifier: Apache-2.0
#include "shared/dynamixel/packet.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared/base/hex_text.hpp"
#include "shared/base/random.hpp"

namespace kaz::dynamixel {
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

// CRC-16/BUYPASS of "123456789", as catalogues of CRCs have it.
TEST(DynamixelPacket, CrcIsThatOfTheCatalogue) {
  const std::string text = "123456789";
  EXPECT_EQ(crc16(Bytes(text.begin(), text.end())), 0xFEE8);
}

TEST(DynamixelPacket, ExamplesOfTheManualAreReadAndWrittenBack) {
  std::ifstream file("shared/dynamixel/corpus/packets.json");
  const auto corpus = nlohmann::json::parse(file);
  ASSERT_GE(corpus.size(), 30u);
  for (const auto& example : corpus) {
    std::vector<std::string> texts = example.at("answers");
    texts.push_back(example.at("request"));
    for (const std::string& text : texts) {
      const Bytes wire = bytes_of(text);
      PacketReader reader;
      const auto packets = packets_in(wire, reader);
      ASSERT_EQ(packets.size(), 1u) << example.at("name") << ": " << text;
      EXPECT_EQ(packets[0].id, wire[4]);
      EXPECT_EQ(packets[0].instruction, wire[7]);
      EXPECT_EQ(reader.counts().skipped_bytes + reader.counts().bad(), 0u);
      // Joined answers are made by several servos, and have no error byte of their own.
      if (packets[0].is_status() && example.contains("joined")) continue;
      EXPECT_EQ(wire_of(packets[0]), wire) << example.at("name") << ": " << hex_text(wire, " ");
    }
  }
}

TEST(DynamixelPacket, BytesThatWerePutInAreTakenOut) {
  PacketReader reader;
  const Bytes plain{0x74, 0x00, 0xFF, 0xFF, 0xFD, 0x00};
  const auto packets =
      packets_in(bytes_of("FF FF FD 00 01 0A 00 03 74 00 FF FF FD FD 00 21 E7"), reader);
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(packets[0].parameters, plain);
  // In a joined answer there are none.
  const Bytes joined{0x00, 0x01, 0xFF, 0xFF, 0xFD, 0xFD};
  Bytes wire = bytes_of("FF FF FD 00 FE 09 00 55");
  wire.insert(wire.end(), joined.begin(), joined.end());
  const auto crc = crc16(wire);
  wire.insert(wire.end(), {low(crc), high(crc)});
  const auto fast = packets_in(wire, reader);
  ASSERT_EQ(fast.size(), 1u);
  EXPECT_EQ(fast[0].parameters, joined);
}

TEST(DynamixelPacket, AnyOneDamagedByteIsSeen) {
  const Bytes good = wire_of(request(1, Instruction::write, {116, 0, 0, 2, 0, 0}));
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

TEST(DynamixelPacket, HeaderInNoiseIsFound) {
  PacketReader reader;
  // A part of a header, data with a byte put in, and one FF too many.
  Bytes wire{0x00, 0xFF, 0x12, 0xFF, 0xFF, 0xFD, 0xFD, 0xFF};
  const Bytes good = wire_of(request(3, Instruction::ping));
  wire.insert(wire.end(), good.begin(), good.end());
  ASSERT_EQ(packets_in(wire, reader).size(), 1u);
  EXPECT_EQ(reader.packet().id, 3);
  EXPECT_EQ(reader.counts().skipped_bytes, 8u);
}

TEST(DynamixelPacket, ManyPacketsInARowAreAllFound) {
  Random random(5);
  PacketReader reader;
  // Few different bytes: headers are among the data.
  static constexpr std::uint8_t kBytes[] = {0xFF, 0xFF, 0xFD, 0xFD, 0x00, 0x55};
  for (int i = 0; i < 20000; ++i) {
    Packet packet{static_cast<std::uint8_t>(random.below(253)),
                  static_cast<std::uint8_t>(random.below(256)),
                  0,
                  {}};
    if (packet.is_status()) packet.error = static_cast<std::uint8_t>(random.below(256));
    packet.parameters.resize(random.below(40));
    for (auto& byte : packet.parameters) byte = kBytes[random.below(std::size(kBytes))];
    const auto found = packets_in(wire_of(packet), reader);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0], packet);
  }
  EXPECT_EQ(reader.counts().skipped_bytes + reader.counts().bad(), 0u);
}

TEST(DynamixelPacket, ALengthThatIsNoneIsRefused) {
  for (const std::size_t length : {std::size_t{0}, std::size_t{2}, kMaxLength + 1}) {
    PacketReader reader;
    for (const int byte : {0xFF, 0xFF, 0xFD, 0x00, 0x01, int{low(length)}})
      (void)reader.take(static_cast<std::uint8_t>(byte));
    EXPECT_EQ(reader.take(high(length)), PacketReader::Event::bad_length) << length;
    EXPECT_EQ(reader.counts().bad_lengths, 1u);
  }
}

}  // namespace
}  // namespace kaz::dynamixel
