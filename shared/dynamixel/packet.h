// Packets of DYNAMIXEL protocol 2.0.
// SPDX-License-Identifier: Apache-2.0
//
//   FF FF FD 00 ID LENGTH(2) INSTRUCTION [ERROR] parameters... CRC(2)
//
// LENGTH counts from INSTRUCTION to CRC. An answer has the instruction `status` and an error byte. Between ID
// and CRC each FF FF FD is followed by one more FD, which LENGTH and CRC count: so no header stands inside of
// a packet. The joined answers of the fast reads have no such bytes. Source: ROBOTIS e-Manual, "DYNAMIXEL
// Protocol 2.0"; docs/reference/servo-bus.md has it in full.
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
  reg_write = 0x04,  // stored until `action`
  action = 0x05,
  factory_reset = 0x06,
  reboot = 0x08,
  clear = 0x10,   // the turns counted
  backup = 0x20,  // of EEPROM and gains, and back
  status = 0x55,  // an answer
  sync_read = 0x82,
  sync_write = 0x83,
  fast_sync_read = 0x8A,
  bulk_read = 0x92,
  bulk_write = 0x93,
  fast_bulk_read = 0x9A,
};

// Low seven bits of the error byte.
enum class Failure : std::uint8_t {
  none = 0,
  result = 1,  // the instruction could not be carried out
  instruction = 2,
  crc = 3,
  range = 4,   // of the register
  length = 5,  // part of a register
  limit = 6,   // of a register that limits this one
  access = 7,  // read-only, locked, or no register
};
// In the error byte besides: hardware_error_status is not 0.
inline constexpr std::uint8_t kAlert = 0x80;

// Bits of hardware_error_status and shutdown.
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
  std::uint8_t error = 0;  // of a status packet
  std::vector<std::uint8_t> parameters;
  bool is_status() const { return instruction == static_cast<std::uint8_t>(Instruction::status); }
  bool operator==(const Packet&) const = default;
};
// What a reader takes; the manual has no limit, ROBOTIS's SDK has this one.
inline constexpr std::size_t kMaxLength = 1024;

// CRC-16 of polynomial 8005, from `crc` on.
std::uint16_t crc16(std::span<const std::uint8_t> bytes, std::uint16_t crc = 0);

// The packet as it stands on the wire.
std::vector<std::uint8_t> wire_of(const Packet& packet);

inline Packet request(std::uint8_t id, Instruction instruction,
                      std::vector<std::uint8_t> parameters = {}) {
  return {id, static_cast<std::uint8_t>(instruction), 0, std::move(parameters)};
}

// A number as two bytes of parameters, low byte first.
inline std::uint8_t low(std::size_t value) {
  return static_cast<std::uint8_t>(value);
}
inline std::uint8_t high(std::size_t value) {
  return static_cast<std::uint8_t>(value >> 8);
}

// Bytes of the joined answer to a fast read before the first servo's: header, id, length, instruction.
inline constexpr std::size_t kFastHead = 8;
// Of one servo besides its data: error, id, CRC.
inline constexpr std::size_t kFastFrame = 4;

// Finds packets in a stream of bytes.
class PacketReader {
 public:
  enum class Event { none, packet, bad_checksum, bad_length };
  using Counts = PacketCounts;

  Event take(std::uint8_t byte);
  // After Event::packet, until the next byte; after bad_checksum what it seems to have been.
  const Packet& packet() const { return packet_; }
  // Drops the packet under way: a gap between its bytes is too long, or a byte had no stop bit.
  void reset();
  bool inside() const { return !bytes_.empty(); }
  const Counts& counts() const { return counts_; }

 private:
  Event finish(Event event);
  void decode();

  std::vector<std::uint8_t> bytes_;  // from the header
  std::size_t wanted_ = 0;           // of the whole packet; 0: its length has not come
  Packet packet_;
  Counts counts_;
};

}  // namespace kaz::dynamixel
