// The clock of another machine, which paces a simulation instead of this machine's clock.
// SPDX-License-Identifier: Apache-2.0
//
// It serves host programs in a virtual machine (tests/system/guest). An emulated processor is slower than
// this one, and its clock may stand still while it computes. A world paced by this machine's clock would run
// ahead. The board's watchdog would then act on a host that is on time by its own clock.
//
// Protocol: a Unix stream socket with one client. The client sends its CLOCK_MONOTONIC in ns, 8 bytes
// little-endian, about once per millisecond. Time stands still between two messages, before the first one
// and without a client. A second client waits until the first one disconnects or has sent nothing for
// kMaxSilence, and then replaces it. The next message is read only when the world has reached the previous
// time. A client with a small socket buffer therefore waits for the world.
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
  // Consumes bytes. Returns Fault::environment if a time is before an earlier one or out of range.
  Result<void> feed(std::span<const std::uint8_t> bytes);
  // Returns the latest time, empty before the first.
  std::optional<Time> latest() const { return latest_; }
  std::size_t part() const { return have_; }  // bytes of an incomplete message
  // Prepares for another client, whose clock may have any value.
  void restart() { *this = {}; }

 private:
  std::array<std::uint8_t, 8> part_{};
  std::size_t have_ = 0;
  std::optional<Time> latest_;
};

class FollowedClock {
 public:
  // Listens on a Unix socket at `path`. Errors as UnixListener::open().
  static Result<std::unique_ptr<FollowedClock>> open(const std::string& path);

  // Reads the next message, if one arrives within `patience` by this machine's clock. Returns true if it is
  // the first time of a new client, so that the clock may have jumped. Errors as ClockStream::feed().
  Result<bool> poll(Time patience);
  // Returns the latest time, zero before the first message.
  Time now() const { return now_; }

  // By this machine's clock. A guest's clock may stand still for longer: only a waiting client replaces it.
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
