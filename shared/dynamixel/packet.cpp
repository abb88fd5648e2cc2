// Packets of DYNAMIXEL protocol 2.0: encoding, and finding them in a stream.
// SPDX-License-Identifier: Apache-2.0
#include "shared/dynamixel/packet.h"

#include <algorithm>
#include <array>

namespace kaz::dynamixel {
namespace {

constexpr std::array<std::uint8_t, 3> kHeader{0xFF, 0xFF, 0xFD};
constexpr std::uint8_t kStuffing = 0xFD;
constexpr std::size_t kBeforeLength = 5, kBeforeInstruction = 7, kCrc = 2;

bool ends_in_header(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kHeader.size() && std::ranges::equal(bytes.last(3), kHeader);
}

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes, std::uint16_t crc) {
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte << 8);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 0x8000) != 0 ? crc << 1 ^ 0x8005 : crc << 1);
  }
  return crc;
}

std::vector<std::uint8_t> wire_of(const Packet& packet) {
  std::vector<std::uint8_t> wire{kHeader.begin(), kHeader.end()};
  wire.insert(wire.end(), {0x00, packet.id, 0, 0});
  const auto add = [&wire](std::uint8_t byte) {
    wire.push_back(byte);
    if (ends_in_header(std::span(wire).subspan(kBeforeInstruction))) wire.push_back(kStuffing);
  };
  add(packet.instruction);
  if (packet.is_status()) add(packet.error);
  for (const std::uint8_t byte : packet.parameters) add(byte);
  const std::size_t length = wire.size() - kBeforeInstruction + kCrc;
  wire[kBeforeLength] = low(length);
  wire[kBeforeLength + 1] = high(length);
  const std::uint16_t crc = crc16(wire);
  wire.insert(wire.end(), {low(crc), high(crc)});
  return wire;
}

PacketReader::Event PacketReader::finish(Event event) {
  bytes_.clear();
  wanted_ = 0;
  if (event == Event::packet) ++counts_.packets;
  if (event == Event::bad_checksum) ++counts_.bad_checksums;
  if (event == Event::bad_length) ++counts_.bad_lengths;
  return event;
}

void PacketReader::reset() {
  if (bytes_.size() > kHeader.size()) {
    ++counts_.abandoned;
  } else {
    counts_.skipped_bytes += bytes_.size();
  }
  bytes_.clear();
  wanted_ = 0;
}

void PacketReader::decode() {
  packet_.id = bytes_[4];
  packet_.instruction = bytes_[kBeforeInstruction];
  packet_.error = 0;
  packet_.parameters.clear();
  const std::span body = std::span(bytes_).subspan(kBeforeInstruction);
  const bool joined = packet_.id == kBroadcast && packet_.is_status();
  std::vector<std::uint8_t> plain;
  for (std::size_t i = 0; i < body.size() - kCrc; ++i) {
    // Behind a header stands the byte that was put in.
    const bool put_in = !joined && body[i] == kStuffing && ends_in_header(body.first(i));
    if (!put_in) plain.push_back(body[i]);
  }
  std::span rest = std::span(plain).subspan(1);
  // Joined answers have an error byte for each servo, among the parameters.
  if (packet_.is_status() && !joined && !rest.empty()) {
    packet_.error = rest[0];
    rest = rest.subspan(1);
  }
  packet_.parameters.assign(rest.begin(), rest.end());
}

PacketReader::Event PacketReader::take(std::uint8_t byte) {
  bytes_.push_back(byte);
  if (bytes_.size() <= kHeader.size()) {
    // The longest end of what has come that a header begins with.
    while (!std::ranges::equal(bytes_, std::span(kHeader).first(bytes_.size()))) {
      bytes_.erase(bytes_.begin());
      ++counts_.skipped_bytes;
    }
    return Event::none;
  }
  if (bytes_.size() == kHeader.size() + 1 && byte == kStuffing) {
    // Data of a packet whose beginning was not heard.
    counts_.skipped_bytes += bytes_.size();
    bytes_.clear();
    return Event::none;
  }
  if (bytes_.size() == kBeforeInstruction) {
    const std::size_t length = bytes_[kBeforeLength] + std::size_t{bytes_[kBeforeLength + 1]} * 256;
    if (length < kCrc + 1 || length > kMaxLength) return finish(Event::bad_length);
    wanted_ = kBeforeInstruction + length;
  }
  if (wanted_ == 0 || bytes_.size() < wanted_) return Event::none;
  decode();
  const std::uint16_t crc = crc16(std::span(bytes_).first(bytes_.size() - kCrc));
  const bool right = bytes_[wanted_ - 2] == low(crc) && bytes_[wanted_ - 1] == high(crc);
  return finish(right ? Event::packet : Event::bad_checksum);
}

}  // namespace kaz::dynamixel
