// One wire shared by a host and servos. Simulates bit by bit which node receives which bytes, and when.
// SPDX-License-Identifier: Apache-2.0
//
// A byte has 8 data bits, no parity and one stop bit. The wire is low while any node sends a low bit. If two
// nodes send different bytes at the same time, the nodes corrupt each other's bytes. Each node has a UART
// with its own baud rate. After a falling edge, the UART samples the wire in the middle of each bit. If the
// baud rates of sender and receiver differ too much, bytes therefore arrive as garbage or with a framing
// error. Without set_echo(), a node does not receive the bytes that it sends. All times are in simulated
// time. The simulation is deterministic: if all calls are repeated with the same arguments, the received
// bytes and their times are identical.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "shared/base/random.hpp"
#include "shared/base/time.hpp"

namespace kaz::sim {

class HalfDuplexLine {
 public:
  explicit HalfDuplexLine(std::size_t nodes, double baud = 1e6);

  // Sets the baud rate of a node for bytes sent or received from now on. Precondition: baud > 0.
  void set_baud(std::size_t node, double baud);
  // Sends the bytes without gaps. The first byte begins at `from` or after the node's earlier bytes,
  // whichever is later. Returns the time at which the last stop bit ends. If the most recent call of
  // next() returned a byte, `from` must not be earlier than the byte's Received::at. If the most recent call
  // of next() returned nullopt, `from` must not be earlier than the argument `until` of that call.
  Time send(std::size_t node, std::span<const std::uint8_t> bytes, Time from);
  // Returns the time at which the nodes have sent all their bytes, including queued bytes. This time is in
  // the past if the wire is idle.
  Time busy_until() const;
  // Damages bytes that are sent from now on: with the probability `share`, one random bit of a byte is
  // flipped.
  void set_damage(double share, std::uint64_t seed);
  // Sets whether a node also receives the bytes that it sends itself.
  void set_echo(std::size_t node, bool on);
  // Number of bytes with a flipped bit.
  std::uint64_t damaged() const { return damaged_; }

  struct Received {
    std::size_t node = 0;
    std::uint8_t byte = 0;
    bool stop_bit = true;  // false: framing error, `byte` is meaningless
    Time at{};             // end of the stop bit, according to the baud rate of the node
  };
  // Returns the earliest byte that any node has received by `until` and that next() has not returned yet.
  // Returns nullopt if no node has received a byte by `until`.
  std::optional<Received> next(Time until);

 private:
  struct WireByte {
    std::size_t node;
    std::uint8_t value;
    double bit_ns;
    Time start, end;
    bool high(int bit) const { return bit > 8 || (bit > 0 && (value >> (bit - 1) & 1) != 0); }
    Time edge(int bit) const { return start + Time(static_cast<std::int64_t>(bit * bit_ns + 0.5)); }
  };
  struct Uart {
    double bit_ns;
    Time from{};         // the UART ignores falling edges before this time
    Time sent_until{};   // end of the bytes that the node itself sends
    bool echo = false;   // the node receives its own bytes
    bool known = false;  // true: `next` is up to date
    std::optional<Received> next;
    // Time of the middle of the stop bit of the byte in `next`. When the function next() returns this
    // byte, the function copies the value of `after` to the variable `from`.
    Time after{};
  };

  // Returns whether the receiver of `node` ignores a byte because the node sends the byte itself.
  bool ignores(std::size_t node, const WireByte& byte) const {
    return byte.node == node && !uarts_[node].echo;
  }
  bool level(std::size_t node, Time at) const;
  std::optional<Time> falling_edge(std::size_t node, Time from) const;
  bool sends(std::size_t node, Time at) const;
  void look_ahead(std::size_t node);
  void forget(Time now);

  std::deque<WireByte> wire_;  // sorted by start
  std::vector<Uart> uarts_;
  Random random_{1};
  double damage_ = 0;
  std::uint64_t damaged_ = 0;
};

}  // namespace kaz::sim
