// Encoder and stream decoder for Feetech servo packets: DYNAMIXEL protocol 1.0 with Feetech's instructions.
// SPDX-License-Identifier: Apache-2.0
//
//   FF FF ID LENGTH CODE parameters... CHECKSUM
//
// LENGTH is the number of bytes from CODE to CHECKSUM: the number of parameters plus 2. CODE is the
// instruction in a request and the status byte (error bits) in a reply. CHECKSUM is the complement of the low
// byte of the sum from ID to the last parameter.
//
// Sources: "Steering Gear SCS Communication Protocol" (Feetech); ROBOTIS e-Manual, "DYNAMIXEL Protocol 1.0".
// docs/reference/servo-bus.md has the details.
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
  reg_write = 0x04,  // prepares a write; a later instruction `action` executes the write
  action = 0x05,
  restore = 0x06,      // restores the registers of the last backup, except the id
  restart = 0x08,      // servos do not reply
  backup = 0x09,       // stores the registers for `restore`
  reset_turns = 0x0A,  // clears the turn counter
  set_middle = 0x0B,   // the present position gets the parameter's value (2 bytes; default 2048)
  sync_read = 0x82,    // parameters: address, length, ids; SCS servos do not support sync_read
  sync_write = 0x83,   // parameters: address, length, then id and data per servo
};

// Bits of the status byte in replies, and of the registers `status`, `unload_condition`, `led_alarm`.
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
  std::uint8_t code = 0;                 // instruction or status byte
  std::vector<std::uint8_t> parameters;  // at most kMaxParameters
  bool operator==(const Packet&) const = default;
};
inline constexpr std::size_t kMaxParameters = 253;  // maximum, because LENGTH is one byte

// Returns the checksum of `bytes`. `bytes` are the bytes of a packet from ID to the last parameter.
std::uint8_t checksum(std::span<const std::uint8_t> bytes);

// Encodes a packet. Precondition: at most kMaxParameters parameters.
std::vector<std::uint8_t> wire_of(const Packet& packet);

// Returns a request packet.
inline Packet request(std::uint8_t id, Instruction instruction,
                      std::vector<std::uint8_t> parameters = {}) {
  return {id, static_cast<std::uint8_t>(instruction), std::move(parameters)};
}

// Stream decoder: finds packets in received bytes. Not thread-safe.
class PacketReader {
 public:
  enum class Event { none, packet, bad_checksum, bad_length };
  using Counts = PacketCounts;

  // Processes one byte. Returns the event that the byte completes, or Event::none.
  Event take(std::uint8_t byte);
  // After Event::packet, returns the received packet. The content is valid until the next Event::packet.
  const Packet& packet() const { return packet_; }
  // Drops an incomplete packet and counts the packet as abandoned. Call reset() after a timeout between
  // bytes or a framing error.
  void reset();
  // Returns true if a packet is incomplete, or if the latest bytes may be the beginning of a header.
  bool inside() const { return state_ != State::header || headers_ > 0; }
  const Counts& counts() const { return counts_; }

 private:
  enum class State { header, id, length, body };
  Event finish(Event event);

  State state_ = State::header;
  int headers_ = 0;                  // FF bytes seen, at most 2
  std::size_t wanted_ = 0;           // bytes still missing, including the checksum
  std::vector<std::uint8_t> bytes_;  // packet so far, from ID
  Packet packet_;
  Counts counts_;
};

}  // namespace kaz::feetech
