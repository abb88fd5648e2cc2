// A request to stop the program, from a signal handler or another thread. The request ends all waits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"

namespace kaz::host {

// Each real-time link, each real-time clock, and each object of a class in interruptible.h gets an Interrupt
// when it is created. After request(), Clock::sleep_until and Link::read fail with error() at once, until
// withdraw() is called. While a CleanUp is active, Clock::sleep_until and Link::read ignore request().
// Link::write always works, so that a program that exits can switch the motors off.
class Interrupt {
 public:
  Interrupt();  // throws std::system_error if no file descriptor is free
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // May be called from any thread and from a signal handler (async-signal-safe).
  void request() noexcept;
  bool requested() const noexcept { return requested_.load(std::memory_order_acquire); }
  // Withdraws a request, for a program that continues. During this call, other threads must not call
  // request() and must not wait.
  void withdraw() noexcept;

  // Whether waits must end: requested() is true, and no clean-up is active.
  bool ends_waiting() const noexcept;

  // Descriptor for poll(). The descriptor becomes readable with request() and stays readable. During a
  // clean-up, returns -1, which poll() ignores.
  int descriptor() const noexcept;
  // Returns the timeout for poll(). `left`: remaining waiting time of the caller. If a clean-up is active and
  // ends before `left` has passed, the timeout is the time until the end of the clean-up. Otherwise the
  // timeout is `left`.
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

// Suspends an interrupt during the lifetime of this object, but at most for `longest`. During this time, the
// program can wait for replies, for example to restore a board. Only one CleanUp may exist at a time.
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
