// Packets of Feetech's servo bus: encoding, and finding them in a stream.
// SPDX-License-Identifier: Apache-2.0
#include "shared/feetech/packet.h"

namespace kaz::feetech {

std::uint8_t checksum(std::span<const std::uint8_t> bytes) {
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return static_cast<std::uint8_t>(~sum);
}

std::vector<std::uint8_t> wire_of(const Packet& packet) {
  std::vector<std::uint8_t> wire{
      0xFF, 0xFF, packet.id, static_cast<std::uint8_t>(packet.parameters.size() + 2), packet.code};
  wire.insert(wire.end(), packet.parameters.begin(), packet.parameters.end());
  wire.push_back(checksum(std::span(wire).subspan(2)));
  return wire;
}

PacketReader::Event PacketReader::finish(Event event) {
  state_ = State::header;
  headers_ = 0;
  if (event == Event::packet) ++counts_.packets;
  if (event == Event::bad_checksum) ++counts_.bad_checksums;
  if (event == Event::bad_length) ++counts_.bad_lengths;
  return event;
}

void PacketReader::reset() {
  if (state_ != State::header) ++counts_.abandoned;
  if (state_ == State::header) counts_.skipped_bytes += static_cast<std::uint64_t>(headers_);
  state_ = State::header;
  headers_ = 0;
}

PacketReader::Event PacketReader::take(std::uint8_t byte) {
  switch (state_) {
    case State::header:
      if (byte == 0xFF) {
        if (++headers_ == 2) state_ = State::id;
      } else {
        counts_.skipped_bytes += static_cast<std::uint64_t>(headers_) + 1;
        headers_ = 0;
      }
      return Event::none;
    case State::id:
      // FF is no id: a third FF in a row moves the header by one byte.
      if (byte == 0xFF) {
        ++counts_.skipped_bytes;
        return Event::none;
      }
      bytes_.assign(1, byte);
      state_ = State::length;
      return Event::none;
    case State::length:
      if (byte < 2) return finish(Event::bad_length);
      bytes_.push_back(byte);
      wanted_ = byte;
      state_ = State::body;
      return Event::none;
    case State::body:
      bytes_.push_back(byte);
      if (--wanted_ > 0) return Event::none;
      break;
  }
  if (checksum(std::span(bytes_).first(bytes_.size() - 1)) != byte)
    return finish(Event::bad_checksum);
  packet_.id = bytes_[0];
  packet_.code = bytes_[2];
  packet_.parameters.assign(bytes_.begin() + 3, bytes_.end() - 1);
  return finish(Event::packet);
}

}  // namespace kaz::feetech
