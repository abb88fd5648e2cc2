// Paces a simulation by the clock of another machine instead of the clock of this machine.
// SPDX-License-Identifier: Apache-2.0
//
// The other machine is a virtual machine that runs host programs (tests/system/guest). An emulated processor
// is slower than a real processor, and the clock of a virtual machine may stand still during computations. A
// world that is paced by this machine's clock would run ahead of the virtual machine. The board's link
// watchdog would then expire although the host is on time by the clock of the virtual machine.
//
// Protocol: a Unix stream socket with one client. About once per millisecond, the client sends the time of
// its CLOCK_MONOTONIC in ns, as 8 bytes, little-endian. Only a message advances the followed clock. Between
// messages, and while there is no client, the followed clock stands still. A second client must wait until
// the first client disconnects or has been silent for kMaxSilence. Then the second client replaces the first
// client. The next message is read only after the world has reached the time of the previous message.
// Therefore a client with a small socket buffer blocks until the world has reached the client's time.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"
#include "sim/runtime/serving/unix_listener.h"

namespace kaz::sim {

// Parses times from the bytes of a stream.
class ClockStream {
 public:
  // Parses bytes. Returns Fault::environment if a time is out of range or earlier than the previous time.
  Result<void> feed(std::span<const std::uint8_t> bytes);
  // Returns the latest time. Before a complete time has been parsed, the result is empty.
  std::optional<Time> latest() const { return latest_; }
  std::size_t part() const { return have_; }  // number of bytes of an incomplete message
  // Forgets the times and bytes of the previous client. The first clock time that the next client sends may
  // have any value.
  void restart() { *this = {}; }

 private:
  std::array<std::uint8_t, 8> part_{};
  std::size_t have_ = 0;
  std::optional<Time> latest_;
};

class FollowedClock {
 public:
  // Listens on a Unix socket at `path`. Returns the errors of UnixListener::open().
  static Result<std::unique_ptr<FollowedClock>> open(const std::string& path);

  // Reads the next message. Waits at most `patience` for the message, measured by this machine's clock.
  // Returns true if the message is the first message of a new client. The first message of a new client may
  // move now() forward or backward by any amount. Returns the errors of ClockStream::feed().
  Result<bool> poll(Time patience);
  // Returns the latest time, or zero before the first message.
  Time now() const { return now_; }

  // Maximum silence of a client, measured by this machine's clock. The clock of a virtual machine may stand
  // still for longer than kMaxSilence. Therefore a silent client keeps the connection unless another client
  // waits.
  static constexpr std::chrono::seconds kMaxSilence{1};

 private:
  explicit FollowedClock(std::unique_ptr<UnixListener> listener) : listener_(std::move(listener)) {}

  using Clock = std::chrono::steady_clock;

  std::unique_ptr<UnixListener> listener_;
  Descriptor client_;
  // Time at which the newest bytes arrived; before the first bytes, time of the connection.
  Clock::time_point heard_{};
  ClockStream stream_;
  Time now_{};
};

}  // namespace kaz::sim
