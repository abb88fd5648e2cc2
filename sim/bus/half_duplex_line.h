// One wire shared by a host and servos. Simulates bit by bit which node receives which bytes, and when.
// SPDX-License-Identifier: Apache-2.0
//
// 8 data bits, no parity, one stop bit. The wire is low while any node sends a low bit, so simultaneous
// senders corrupt each other's bytes where the bytes differ. Each node has a UART with its own baud rate.
// After a falling edge, the UART samples the middle of each bit. So bytes that were sent at another rate
// arrive as garbage or with a framing error. A node does not receive its own bytes. Time is simulated. The
// same calls give the same bytes.
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
  // Sends the bytes without gaps, beginning at `from` or after the node's earlier bytes, whichever is later.
  // Returns the end of the last stop bit. Precondition: `from` is not before the last byte returned by
  // next().
  Time send(std::size_t node, std::span<const std::uint8_t> bytes, Time from);
  // Returns the end of the last byte on the wire or queued; in the past if the wire is idle.
  Time busy_until() const;
  // From now on, one random bit of each sent byte is flipped with the probability `share`.
  void set_damage(double share, std::uint64_t seed);
  // Number of bytes with a flipped bit.
  std::uint64_t damaged() const { return damaged_; }

  struct Received {
    std::size_t node = 0;
    std::uint8_t byte = 0;
    bool stop_bit = true;  // false: framing error, `byte` is meaningless
    Time at{};             // end of the stop bit, according to the baud rate of this node
  };
  // Returns the next byte, in order of time, that any node has received by `until`. Returns nullopt if there
  // is no such byte.
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
    Time from{};         // falling edges before this time are not start bits
    Time sent_until{};   // end of the node's own bytes
    bool known = false;  // `next` is up to date
    std::optional<Received> next;
    Time after{};  // new value of `from` after `next` was returned
  };

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
