// Packets of Feetech and DYNAMIXEL buses, written independently from docs/reference/servo-bus.md.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bus/servo_wire.h"

#include <numeric>

namespace kaz::hil {
namespace {

constexpr std::uint8_t kStatus = 0x55;
constexpr std::size_t kFeetechHead = 4, kDynamixelHead = 7;  // up to and with LENGTH

std::uint8_t complement_of_sum(const Bytes& bytes, std::size_t from, std::size_t to) {
  const auto at = [&](std::size_t i) { return bytes.begin() + static_cast<std::ptrdiff_t>(i); };
  return static_cast<std::uint8_t>(~std::accumulate(at(from), at(to), 0u));
}

std::uint16_t crc_8005(const Bytes& bytes, std::size_t from, std::size_t to) {
  unsigned crc = 0;
  for (std::size_t i = from; i < to; ++i) {
    crc ^= static_cast<unsigned>(bytes[i]) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1) ^ ((crc & 0x8000) != 0 ? 0x8005 : 0);
    crc &= 0xFFFF;
  }
  return static_cast<std::uint16_t>(crc);
}

bool ends_like_a_header(const Bytes& bytes) {
  const std::size_t n = bytes.size();
  return n >= 3 && bytes[n - 3] == 0xFF && bytes[n - 2] == 0xFF && bytes[n - 1] == 0xFD;
}

// Between LENGTH and CRC an FD follows each FF FF FD.
Bytes filled(const Bytes& body) {
  Bytes all;
  for (const std::uint8_t byte : body) {
    all.push_back(byte);
    if (ends_like_a_header(all)) all.push_back(0xFD);
  }
  return all;
}

Bytes emptied(const Bytes& body) {
  Bytes all;
  for (std::size_t i = 0; i < body.size(); ++i) {
    all.push_back(body[i]);
    if (ends_like_a_header(all) && i + 1 < body.size() && body[i + 1] == 0xFD) ++i;
  }
  return all;
}

// Each returns how many bytes the packet at `at` has; 0: none begins there; more than are there: it is open.
std::size_t feetech_at(const Bytes& bytes, std::size_t at) {
  const std::size_t left = bytes.size() - at;
  if (bytes[at] != 0xFF || (left > 1 && bytes[at + 1] != 0xFF)) return 0;
  if (left > 2 && bytes[at + 2] == 0xFF) return 0;  // the header begins a byte later
  if (left < kFeetechHead) return left + 1;
  return kFeetechHead + bytes[at + 3];
}

std::size_t dynamixel_at(const Bytes& bytes, std::size_t at) {
  static constexpr std::uint8_t kHeader[] = {0xFF, 0xFF, 0xFD, 0x00};
  const std::size_t left = bytes.size() - at;
  for (std::size_t i = 0; i < sizeof kHeader && i < left; ++i)
    if (bytes[at + i] != kHeader[i]) return 0;
  if (left < kDynamixelHead) return left + 1;
  return kDynamixelHead + bytes[at + 5] + bytes[at + 6] * 256u;
}

bool take_feetech(const Bytes& packet, ServoAnswers& answers) {
  const std::size_t end = packet.size() - 1;
  if (packet.size() < 6 || complement_of_sum(packet, 2, end) != packet[end]) return false;
  answers.all.push_back({packet[2], packet[4], {packet.begin() + 5, packet.end() - 1}});
  return true;
}

bool take_dynamixel(const Bytes& packet, ServoAnswers& answers) {
  const std::size_t end = packet.size() - 2;
  if (packet.size() < 11) return false;
  if (crc_8005(packet, 0, end) != packet[end] + packet[end + 1] * 256) return false;
  Bytes body(packet.begin() + kDynamixelHead, packet.end() - 2);
  // Nothing is put into the joined answers of the fast reads.
  if (packet[4] != kAllServos) body = emptied(body);
  if (body[0] != kStatus) return false;
  answers.all.push_back({packet[4], body[1], {body.begin() + 2, body.end()}});
  return true;
}

}  // namespace

Bytes servo_request(ServoFamily family, int id, int instruction, const Bytes& parameters) {
  Bytes body{static_cast<std::uint8_t>(instruction)};
  body.insert(body.end(), parameters.begin(), parameters.end());
  Bytes all;
  if (family == ServoFamily::feetech) {
    all = {0xFF, 0xFF, static_cast<std::uint8_t>(id), static_cast<std::uint8_t>(body.size() + 1)};
    all.insert(all.end(), body.begin(), body.end());
    all.push_back(complement_of_sum(all, 2, all.size()));
    return all;
  }
  body = filled(body);
  const std::size_t length = body.size() + 2;
  all = {0xFF,
         0xFF,
         0xFD,
         0x00,
         static_cast<std::uint8_t>(id),
         static_cast<std::uint8_t>(length),
         static_cast<std::uint8_t>(length >> 8)};
  all.insert(all.end(), body.begin(), body.end());
  const std::uint16_t crc = crc_8005(all, 0, all.size());
  all.push_back(static_cast<std::uint8_t>(crc));
  all.push_back(static_cast<std::uint8_t>(crc >> 8));
  return all;
}

Bytes damaged(Bytes request) {
  request.back() ^= 0x40;
  return request;
}

ServoAnswers answers_in(ServoFamily family, const Bytes& bytes) {
  const bool feetech = family == ServoFamily::feetech;
  ServoAnswers answers;
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t size = feetech ? feetech_at(bytes, at) : dynamixel_at(bytes, at);
    if (size == 0) {
      ++answers.stray;
      ++at;
      continue;
    }
    if (size > bytes.size() - at) {
      answers.open = true;
      return answers;
    }
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const Bytes packet(begin, begin + static_cast<std::ptrdiff_t>(size));
    if (!(feetech ? take_feetech(packet, answers) : take_dynamixel(packet, answers)))
      ++answers.damaged;
    at += size;
  }
  return answers;
}

}  // namespace kaz::hil
