// The clock of another machine, which paces a simulation instead of this machine's.
// SPDX-License-Identifier: Apache-2.0
//
// For a host program in a virtual machine (tests/system/guest): an emulated processor is slower than this
// one, and its clock may stand still while it computes. A world paced by this machine's clock would run away
// from it, and the board's watchdog would act on a host that is not late by its own clock.
//
// A Unix stream socket; the one client sends its CLOCK_MONOTONIC in ns, 8 bytes little-endian, about once per
// millisecond. The time stands still between two messages, before the first and while nobody is connected.
// Another client waits until the first one disconnects or has sent nothing for kMaxSilence, and then replaces
// it.
// One message is read at a time, when the world has come to the one before: a client whose socket holds few
// bytes waits for the world.
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

// Times out of the bytes of a stream.
class ClockStream {
 public:
  // The latest time, once there was one. Errors (environment): a time before an earlier one, or out of range.
  Result<void> feed(std::span<const std::uint8_t> bytes);
  std::optional<Time> latest() const { return latest_; }
  std::size_t part() const { return have_; }  // bytes of a message that has not come whole
  // Of another client, whose clock may be any.
  void restart() { *this = {}; }

 private:
  std::array<std::uint8_t, 8> part_{};
  std::size_t have_ = 0;
  std::optional<Time> latest_;
};

class FollowedClock {
 public:
  // Errors: those of UnixListener.
  static Result<std::unique_ptr<FollowedClock>> open(const std::string& path);

  // Reads the next message. At most `patience` is waited for, by this machine's clock, and less if something
  // comes. True: another clock than before, because a client has connected and sent its first time. Errors:
  // those of ClockStream.
  Result<bool> poll(Time patience);
  // Zero before the first message.
  Time now() const { return now_; }

  // By this machine's clock. A guest's clock may stand still for longer: it is only replaced by a client.
  static constexpr std::chrono::seconds kMaxSilence{1};

 private:
  explicit FollowedClock(std::unique_ptr<UnixListener> listener) : listener_(std::move(listener)) {}

  using Clock = std::chrono::steady_clock;

  std::unique_ptr<UnixListener> listener_;
  Descriptor client_;
  Clock::time_point heard_{};  // when the client connected, or its newest bytes came
  ClockStream stream_;
  Time now_{};
};

}  // namespace kaz::sim
