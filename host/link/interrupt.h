// A request to stop, made by a signal handler or another thread, that wakes whoever waits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::host {

// Given at construction to the links and clocks of real time. Once requested, Clock::sleep_until
// and Link::read fail with `error()` at once and for good; Link::write still works, so that a
// program that is exiting can switch the motors off.
class Interrupt {
 public:
  Interrupt();  // throws std::system_error if the process has no file descriptor left
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // From any thread, and from a signal handler (async-signal-safe).
  void request() noexcept;
  bool requested() const noexcept { return requested_.load(std::memory_order_acquire); }

  // Becomes readable on request, and stays so: for poll().
  int descriptor() const noexcept { return descriptor_; }

  // What an interrupted call returns: Fault::failed, "interrupted ...".
  static Error error();

 private:
  std::atomic<bool> requested_{false};
  int descriptor_;
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace kaz::host
