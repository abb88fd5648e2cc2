// Interfaces of the host's transport: a byte link to a line of boards, and a clock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"  // Time

namespace kaz::host {

// Source of time: CLOCK_MONOTONIC (tty, CAN) or simulated time (lockstep).
class Clock {
 public:
  virtual ~Clock() = default;
  virtual Time now() const = 0;
  // Returns at `t` or, in real time, a little later. Fails if the simulation under it failed, or if
  // the program was interrupted (interrupt.h).
  virtual Result<void> sleep_until(Time t) = 0;
};

// A byte stream to one line of boards: tty, CAN, or in process.
class Link {
 public:
  virtual ~Link() = default;
  virtual std::string name() const = 0;  // for messages: "/dev/ttyUSB0", "can0", "the simulator"
  // Minimum duration of one byte on the wire; zero if unknown. Tightens the bounds of the clock relation
  // (clock_relation.h).
  virtual Time byte_time() const { return Time::zero(); }
  // Another bit rate for both directions from now on; bytes still queued may leave at either.
  virtual Result<void> set_baud(int baud) {
    return fail(Fault::usage, name() + " cannot change its bit rate to " + std::to_string(baud));
  }
  // Queues bytes for the wire; does not wait for them to leave.
  virtual Result<void> write(std::span<const std::uint8_t> bytes) = 0;
  // Waits until at least one byte is there or `deadline` has come; returns how many were stored (0:
  // none came). Fails when the link is gone for good (port closed or unplugged) or the program was
  // interrupted.
  virtual Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) = 0;
  // Reopens the port, e.g. after it was plugged in again. Called after `write` or `read` has failed,
  // repeatedly until it succeeds. Buffered bytes are lost.
  virtual Result<void> reopen() { return {}; }
};

}  // namespace kaz::host
