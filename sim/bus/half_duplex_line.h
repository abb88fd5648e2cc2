// One wire shared by a host and servos, bit by bit: who hears what, and when.
// SPDX-License-Identifier: Apache-2.0
//
// 8 data bits, no parity, one stop bit. The wire is low while any node sends a low bit, so nodes that send at
// once damage each other's bytes where these differ. Each node has a UART with its own rate: it samples in
// the middle of each bit after a falling edge, hence bytes at another rate arrive as garbage or without a
// stop bit. A node does not hear what it sends itself. Simulated time; same calls, same bytes.
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

  // For bytes sent or received from now on. baud > 0.
  void set_baud(std::size_t node, double baud);
  // Sends the bytes without a pause between them, from `from` on or when the node's earlier ones are out.
  // Returns the end of the last stop bit. `from` is not before the last event of next().
  Time send(std::size_t node, std::span<const std::uint8_t> bytes, Time from);
  // End of the last byte that is on the wire or queued; in the past if there is none.
  Time busy_until() const;
  // Each byte sent is changed in one bit, or not, with this probability.
  void set_damage(double share, std::uint64_t seed);
  std::uint64_t damaged() const { return damaged_; }

  struct Received {
    std::size_t node = 0;
    std::uint8_t byte = 0;
    bool stop_bit = true;  // false: framing error, `byte` means nothing
    Time at{};             // end of the stop bit, as this node's UART counts it
  };
  // The next byte that some node has received at `until` or before, in order of time.
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
    Time from{};         // falling edges before are not start bits
    Time sent_until{};   // end of the node's own bytes
    bool known = false;  // `next` is up to date
    std::optional<Received> next;
    Time after{};  // `from` once `next` is taken
  };

  bool level(std::size_t node, Time at) const;
  std::optional<Time> falling_edge(std::size_t node, Time from) const;
  bool sends(std::size_t node, Time at) const;
  void look_ahead(std::size_t node);
  void forget(Time now);

  std::deque<WireByte> wire_;  // by start
  std::vector<Uart> uarts_;
  Random random_{1};
  double damage_ = 0;
  std::uint64_t damaged_ = 0;
};

}  // namespace kaz::sim
