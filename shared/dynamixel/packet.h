// Encoder and stream decoder for packets of DYNAMIXEL protocol 2.0.
// SPDX-License-Identifier: Apache-2.0
//
//   FF FF FD 00 ID LENGTH(2) INSTRUCTION [ERROR] parameters... CRC(2)
//
// LENGTH is the size from INSTRUCTION to CRC. In a reply, INSTRUCTION is `status`, and an ERROR byte follows.
// A request has no ERROR byte.
//
// Byte stuffing: from INSTRUCTION on, each FF FF FD is followed by another FD, so no header occurs inside a
// packet. LENGTH and CRC include the added bytes. A joined reply to a fast read (see kFastHead) has no byte
// stuffing.
//
// Source: ROBOTIS e-Manual, "DYNAMIXEL Protocol 2.0". docs/reference/servo-bus.md has the details.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "shared/base/packet_counts.hpp"

namespace kaz::dynamixel {

inline constexpr std::uint8_t kMaxId = 0xFC, kBroadcast = 0xFE;

enum class Instruction : std::uint8_t {
  ping = 0x01,
  read = 0x02,
  write = 0x03,
  reg_write = 0x04,  // prepares a write; a later instruction `action` executes the write
  action = 0x05,
  factory_reset = 0x06,
  reboot = 0x08,
  clear = 0x10,   // clears the counted turns
  backup = 0x20,  // stores or restores EEPROM registers and gains
  status = 0x55,  // a reply
  sync_read = 0x82,
  sync_write = 0x83,
  fast_sync_read = 0x8A,
  bulk_read = 0x92,
  bulk_write = 0x93,
  fast_bulk_read = 0x9A,
};

// Error code in the low seven bits of a status packet's error byte.
enum class Failure : std::uint8_t {
  none = 0,
  result = 1,  // execution of the instruction failed
  instruction = 2,
  crc = 3,
  range = 4,   // value out of the register's range
  length = 5,  // the written data stop in the middle of a register
  limit = 6,   // value beyond the limit set by another register
  access = 7,  // the register is read-only or locked, or the address has no register
};
// Flag in the error byte: hardware_error_status is not 0.
inline constexpr std::uint8_t kAlert = 0x80;

// Bits of the registers hardware_error_status and shutdown.
enum HardwareError : std::uint8_t {
  kVoltageError = 1,
  kTemperatureError = 4,
  kEncoderError = 8,
  kShockError = 16,
  kOverloadError = 32,
};

struct Packet {
  std::uint8_t id = 0;
  std::uint8_t instruction = 0;
  std::uint8_t error = 0;  // only in status packets
  std::vector<std::uint8_t> parameters;
  bool is_status() const { return instruction == static_cast<std::uint8_t>(Instruction::status); }
  bool operator==(const Packet&) const = default;
};
// Maximum LENGTH that PacketReader accepts. The manual states no limit; 1024 is the limit in ROBOTIS's SDK.
inline constexpr std::size_t kMaxLength = 1024;

// Returns the CRC-16 (polynomial 8005) of `bytes`, starting from `crc`.
std::uint16_t crc16(std::span<const std::uint8_t> bytes, std::uint16_t crc = 0);

// Encodes a packet: adds header, length, stuffing and CRC.
std::vector<std::uint8_t> wire_of(const Packet& packet);

// Returns a request packet.
inline Packet request(std::uint8_t id, Instruction instruction,
                      std::vector<std::uint8_t> parameters = {}) {
  return {id, static_cast<std::uint8_t>(instruction), 0, std::move(parameters)};
}

// Bytes of a 16-bit number; low byte first on the wire.
inline std::uint8_t low(std::size_t value) {
  return static_cast<std::uint8_t>(value);
}
inline std::uint8_t high(std::size_t value) {
  return static_cast<std::uint8_t>(value >> 8);
}

// Several servos answer a fast read with one joined reply. kFastHead is the number of bytes at the start of
// the joined reply: header, id, length and instruction.
inline constexpr std::size_t kFastHead = 8;
// kFastFrame is the number of bytes that each servo adds to its data in a joined reply: error, id and CRC.
inline constexpr std::size_t kFastFrame = 4;

// Stream decoder: finds packets in received bytes. Not thread-safe.
class PacketReader {
 public:
  enum class Event { none, packet, bad_checksum, bad_length };
  using Counts = PacketCounts;

  // Processes one byte. Returns the event that the byte completes, or Event::none.
  Event take(std::uint8_t byte);
  // After Event::packet, returns the received packet; the content is valid until the next byte. After
  // Event::bad_checksum, returns the content of the damaged packet.
  const Packet& packet() const { return packet_; }
  // Drops an incomplete packet and counts the packet as abandoned. Call reset() after a timeout between
  // bytes or a framing error.
  void reset();
  // Returns true if a packet is incomplete, or if the latest bytes may be the beginning of a header.
  bool inside() const { return !bytes_.empty(); }
  const Counts& counts() const { return counts_; }

 private:
  Event finish(Event event);
  void decode();

  std::vector<std::uint8_t> bytes_;  // packet so far, from the header
  std::size_t wanted_ = 0;           // size of the whole packet; 0: unknown yet
  Packet packet_;
  Counts counts_;
};

}  // namespace kaz::dynamixel
