// A request to stop, from a signal handler or another thread, that ends all waiting.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"  // Time

namespace kaz::host {

// Passed at construction to the links and clocks of real time, and to those of interruptible.h. After
// request(), Clock::sleep_until and Link::read fail with error() at once, until withdraw(). A CleanUp
// suspends this. Link::write still works, so that a program that exits can switch the motors off.
class Interrupt {
 public:
  Interrupt();  // throws std::system_error if no file descriptor is free
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // May be called from any thread and from a signal handler (async-signal-safe).
  void request() noexcept;
  bool requested() const noexcept { return requested_.load(std::memory_order_acquire); }
  // Withdraws a request, for a program that continues. No other thread may request or wait meanwhile.
  void withdraw() noexcept;

  // Whether waits must end: requested, and no clean-up is active.
  bool ends_waiting() const noexcept;

  // For poll(): becomes readable on request and stays so. Returns -1, which poll() ignores, during a
  // clean-up.
  int descriptor() const noexcept;
  // Longest time that poll() may wait if `left` remains: during a clean-up, not beyond its end.
  Time max_wait(Time left) const noexcept;

  // The error of an interrupted call: Fault::interrupted, "interrupted".
  static Error error();

 private:
  friend class CleanUp;
  bool cleaning() const noexcept;

  std::atomic<bool> requested_{false};
  std::atomic<std::int64_t> clean_until_ns_{0};  // on the steady clock; 0: no clean-up
  int descriptor_;
  static_assert(std::atomic<bool>::is_always_lock_free);
};

// Suspends an interrupt for its lifetime, at most for `longest`. Waits and reads work meanwhile, so that a
// board can be restored and its replies read. Only one CleanUp may exist at a time.
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
