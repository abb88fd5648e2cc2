// COBS and CRC-16/IBM-3740, bit by bit as docs/reference/protocol.md specifies them.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/codec.h"

#include <cstddef>
#include <cstdio>

namespace kaz::hil {
namespace {

constexpr std::size_t kCheckSize = 3;
constexpr std::size_t kHeaderSize = 3;

std::optional<Bytes> unstuff(const Bytes& stuffed) {
  Bytes body;
  std::size_t at = 0;
  while (at < stuffed.size()) {
    const std::size_t block = stuffed[at];
    if (block == 0 || at + block > stuffed.size()) return std::nullopt;
    for (std::size_t i = 1; i < block; ++i) body.push_back(stuffed[at + i]);
    at += block;
    if (at < stuffed.size()) body.push_back(0);
  }
  return body;
}

}  // namespace

std::uint16_t crc_of(const Bytes& stuffed) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : stuffed) {
    crc ^= static_cast<unsigned>(byte) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 0x8000 ? (crc << 1) ^ 0x1021 : crc << 1;
    crc &= 0xFFFF;
  }
  return static_cast<std::uint16_t>(crc);
}

Bytes stuff(const Bytes& body) {
  Bytes out{0};
  std::size_t length_at = 0;
  for (const std::uint8_t byte : body) {
    if (byte != 0) {
      out.push_back(byte);
      continue;
    }
    out[length_at] = static_cast<std::uint8_t>(out.size() - length_at);
    length_at = out.size();
    out.push_back(0);
  }
  out[length_at] = static_cast<std::uint8_t>(out.size() - length_at);
  return out;
}

Bytes check_of(std::uint16_t crc) {
  return {static_cast<std::uint8_t>(0x80 | crc >> 14),
          static_cast<std::uint8_t>(0x80 | (crc >> 7 & 0x7F)),
          static_cast<std::uint8_t>(0x80 | (crc & 0x7F))};
}

Bytes frame_of_stuffed(const Bytes& stuffed) {
  Bytes wire;
  wire.reserve(stuffed.size() + kCheckSize + 2);
  wire.push_back(0);
  for (const std::uint8_t byte : stuffed) wire.push_back(byte);
  for (const std::uint8_t byte : check_of(crc_of(stuffed))) wire.push_back(byte);
  wire.push_back(0);
  return wire;
}

Bytes frame_of(std::uint8_t address, std::uint8_t type, std::uint8_t sequence,
               const Bytes& fields) {
  Bytes body;
  body.reserve(kHeaderSize + fields.size());
  for (const std::uint8_t byte : {address, type, sequence}) body.push_back(byte);
  for (const std::uint8_t byte : fields) body.push_back(byte);
  return frame_of_stuffed(stuff(body));
}

std::optional<Frame> Deframer::take(std::uint8_t byte, Time at) {
  if (!in_frame_) {
    if (byte == 0) {
      in_frame_ = true;
      bytes_.clear();
    } else {
      ++faults_;
    }
    return std::nullopt;
  }
  if (byte != 0) {
    bytes_.push_back(byte);
    return std::nullopt;
  }
  if (bytes_.empty()) {  // the opening zero again
    ++faults_;
    return std::nullopt;
  }
  in_frame_ = false;
  return end(at);
}

std::optional<Frame> Deframer::end(Time at) {
  if (bytes_.size() > kCheckSize) {
    const auto split = bytes_.end() - static_cast<std::ptrdiff_t>(kCheckSize);
    const Bytes stuffed(bytes_.begin(), split);
    const auto body = unstuff(stuffed);
    if (Bytes(split, bytes_.end()) == check_of(crc_of(stuffed)) && body &&
        body->size() >= kHeaderSize) {
      return Frame{(*body)[0],
                   (*body)[1],
                   (*body)[2],
                   {body->begin() + static_cast<std::ptrdiff_t>(kHeaderSize), body->end()},
                   at};
    }
  }
  // This zero may be the opening one of the next frame.
  ++faults_;
  in_frame_ = true;
  bytes_.clear();
  return std::nullopt;
}

}  // namespace kaz::hil
