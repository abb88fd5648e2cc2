// Interfaces of the host's transport: a byte link to a line of boards, and a clock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"

namespace kaz::host {

// Source of time: CLOCK_MONOTONIC for real links (tty, CAN), or simulated time.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual Time now() const = 0;
  // Returns at `t` or, in real time, slightly later. Fails if the simulation fails, or if the program is
  // interrupted (interrupt.h).
  virtual Result<void> sleep_until(Time t) = 0;
};

// A byte stream to one line of boards: over a tty, over CAN, or within the process.
class Link {
 public:
  virtual ~Link() = default;
  virtual std::string name() const = 0;  // for messages: "/dev/ttyUSB0", "can0", "the simulator"
  // Minimum duration of one byte on the wire; zero if unknown. A known duration tightens the error bounds of
  // ClockRelation.
  virtual Time byte_time() const { return Time::zero(); }
  // Sets the bit rate of both directions. Bytes that are still queued may leave at the old rate or at the new
  // rate.
  virtual Result<void> set_baud(int baud) {
    return fail(Fault::usage, name() + " cannot change its bit rate to " + std::to_string(baud));
  }
  // Queues bytes for the wire. Does not wait until the bytes have left.
  virtual Result<void> write(std::span<const std::uint8_t> bytes) = 0;
  // Waits for at least one byte or until `deadline`. Returns the number of bytes stored, 0 at the deadline.
  // Fails if the link is lost (port closed or unplugged) or the program is interrupted.
  virtual Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) = 0;
  // Reopens the port, for example after the adapter was plugged in again. After a failed `write` or `read`,
  // callers repeat reopen() until it succeeds. Buffered bytes are lost.
  virtual Result<void> reopen() { return {}; }
};

}  // namespace kaz::host
