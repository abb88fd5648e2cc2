// A request to stop, made by a signal handler or another thread, that wakes whoever waits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"  // Time

namespace kaz::host {

// Given at construction to the links and clocks of real time, and to those of interruptible.h. Once
// requested, Clock::sleep_until and Link::read fail with `error()` at once, until withdraw(), except in a
// CleanUp; Link::write still works, so that a program that is exiting can switch the motors off.
class Interrupt {
 public:
  Interrupt();  // throws std::system_error if the process has no file descriptor left
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // From any thread, and from a signal handler (async-signal-safe).
  void request() noexcept;
  bool requested() const noexcept { return requested_.load(std::memory_order_acquire); }
  // Takes requests back, for a program that goes on. Not while another thread may request or wait.
  void withdraw() noexcept;

  // Whether waiting ends: requested, and no clean-up is under way.
  bool ends_waiting() const noexcept;

  // Becomes readable on request, and stays so: for poll(). -1, which poll() ignores, during a clean-up.
  int descriptor() const noexcept;
  // How long poll() may wait at most of `left`: during a clean-up not beyond its end.
  Time max_wait(Time left) const noexcept;

  // What an interrupted call returns: Fault::interrupted, "interrupted".
  static Error error();

 private:
  friend class CleanUp;
  bool cleaning() const noexcept;

  std::atomic<bool> requested_{false};
  std::atomic<std::int64_t> clean_until_ns_{0};  // of the steady clock
  int descriptor_;
  static_assert(std::atomic<bool>::is_always_lock_free);
};

// While it lives, and no longer than `longest`, waiting and reading work although the interrupt was or
// will be requested: a board is put back as it was found, its replies included. One at a time.
class CleanUp {
 public:
  explicit CleanUp(Interrupt& interrupt,
                   std::chrono::milliseconds longest = std::chrono::milliseconds(700));
  ~CleanUp();
  CleanUp(const CleanUp&) = delete;
  CleanUp& operator=(const CleanUp&) = delete;

 private:
  Interrupt& interrupt_;
};

}  // namespace kaz::host
