// Paces a simulation by the clock of another machine instead of the clock of this machine.
// SPDX-License-Identifier: Apache-2.0
//
// The other machine is a virtual machine with host programs (tests/system/guest). An emulated processor is
// slower than a real processor, and the clock of a virtual machine may stand still during computations. A
// world paced by this machine's clock would run ahead. The board's watchdog would then act on a host that is
// on time by the clock of its virtual machine.
//
// Protocol: a Unix stream socket with one client. About once per millisecond, the client sends its
// CLOCK_MONOTONIC in ns, as 8 bytes little-endian. The followed clock stands still between two messages,
// before the first message and without a client. A second client waits until the first client disconnects or
// has sent nothing for kMaxSilence; then the second client replaces the first. The next message is read only
// when the world has reached the time of the previous message. A client with a small socket buffer therefore
// waits for the world.
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
#include "sim/runtime/serving/unix_listener.h"
#include "vision/image/frame.h"  // Time

namespace kaz::sim {

// Parses times from the bytes of a stream.
class ClockStream {
 public:
  // Consumes bytes. Returns Fault::environment if a time is less than an earlier time or out of range.
  Result<void> feed(std::span<const std::uint8_t> bytes);
  // Returns the latest time; empty before the first time.
  std::optional<Time> latest() const { return latest_; }
  std::size_t part() const { return have_; }  // number of bytes of an incomplete message
  // Prepares for another client, whose clock may have any value.
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

  // Reads the next message. Waits for the message for at most `patience` by this machine's clock. Returns
  // true for the first time of a new client, because the clock may then have jumped. Returns the errors of
  // ClockStream::feed().
  Result<bool> poll(Time patience);
  // Returns the latest time, zero before the first message.
  Time now() const { return now_; }

  // Maximum silence by this machine's clock. A guest's clock may stand still for longer. A silent client is
  // only replaced if another client waits.
  static constexpr std::chrono::seconds kMaxSilence{1};

 private:
  explicit FollowedClock(std::unique_ptr<UnixListener> listener) : listener_(std::move(listener)) {}

  using Clock = std::chrono::steady_clock;

  std::unique_ptr<UnixListener> listener_;
  Descriptor client_;
  Clock::time_point heard_{};  // time of the connection or of the newest bytes
  ClockStream stream_;
  Time now_{};
};

}  // namespace kaz::sim
