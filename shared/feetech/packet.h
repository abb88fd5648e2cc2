// Packets of Feetech's servo bus: DYNAMIXEL protocol 1.0 with instructions of Feetech's own.
// SPDX-License-Identifier: Apache-2.0
//
//   FF FF ID LENGTH CODE parameters... CHECKSUM
//
// LENGTH counts from CODE to CHECKSUM: parameters + 2. CODE is the instruction of a request and the status
// byte (error bits) of an answer. CHECKSUM is the complement of the low byte of the sum from ID to the last
// parameter. Sources: "Steering Gear SCS Communication Protocol" (Feetech); ROBOTIS e-Manual, "DYNAMIXEL
// Protocol 1.0". docs/reference/servo-bus.md has both in full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/base/packet_counts.hpp"

namespace kaz::feetech {

inline constexpr std::uint8_t kMaxId = 0xFD, kBroadcast = 0xFE;

enum class Instruction : std::uint8_t {
  ping = 0x01,
  read = 0x02,
  write = 0x03,
  reg_write = 0x04,  // stored until `action`
  action = 0x05,
  restore = 0x06,      // registers back to the last backup, but for the id
  restart = 0x08,      // no answer
  backup = 0x09,       // of the registers, for `restore`
  reset_turns = 0x0A,  // clears the turn counter
  set_middle = 0x0B,   // the present position becomes the middle, or the 2-byte parameter
  sync_read = 0x82,    // address, length, ids; not SCS
  sync_write = 0x83,   // address, length, then id and data of each servo
};

// Bits of the status byte of an answer, and of the registers `status`, `unload_condition`, `led_alarm`.
enum StatusBit : std::uint8_t {
  kVoltageError = 1,
  kEncoderError = 2,
  kTemperatureError = 4,
  kCurrentError = 8,
  kAngleError = 16,
  kOverloadError = 32,
};

struct Packet {
  std::uint8_t id = 0;
  std::uint8_t code = 0;
  std::vector<std::uint8_t> parameters;  // at most kMaxParameters
  bool operator==(const Packet&) const = default;
};
inline constexpr std::size_t kMaxParameters = 253;  // LENGTH is one byte

// Complement of the low byte of the sum; `bytes` from ID to the last parameter.
std::uint8_t checksum(std::span<const std::uint8_t> bytes);

// The packet as it stands on the wire.
std::vector<std::uint8_t> wire_of(const Packet& packet);

inline Packet request(std::uint8_t id, Instruction instruction,
                      std::vector<std::uint8_t> parameters = {}) {
  return {id, static_cast<std::uint8_t>(instruction), std::move(parameters)};
}

// Finds packets in a stream of bytes.
class PacketReader {
 public:
  enum class Event { none, packet, bad_checksum, bad_length };
  using Counts = PacketCounts;

  Event take(std::uint8_t byte);
  // After Event::packet, until the next byte.
  const Packet& packet() const { return packet_; }
  // Drops the packet under way: a gap between its bytes is too long, or a byte had no stop bit.
  void reset();
  bool inside() const { return state_ != State::header || headers_ > 0; }
  const Counts& counts() const { return counts_; }

 private:
  enum class State { header, id, length, body };
  Event finish(Event event);

  State state_ = State::header;
  int headers_ = 0;                  // FF bytes seen, at most 2
  std::size_t wanted_ = 0;           // bytes still to come, checksum included
  std::vector<std::uint8_t> bytes_;  // from ID
  Packet packet_;
  Counts counts_;
};

}  // namespace kaz::feetech
