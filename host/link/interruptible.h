// Interruptible link and clock for simulated time.
// SPDX-License-Identifier: Apache-2.0
//
// In simulated time, a wait consists of computing the simulation. The classes below divide each wait into
// slices, so that an interrupt ends even a long wait soon. The slices do not change the simulation.
#pragma once

#include <algorithm>
#include <span>
#include <string>

#include "host/link/interrupt.h"
#include "host/link/link.h"

namespace kaz::host {

// Length of a slice in simulated time. With a slow emulated board and world, the computation of a slice takes
// about 10 ms of wall time.
inline constexpr Time kInterruptSlice = std::chrono::milliseconds(10);

class InterruptibleClock final : public Clock {
 public:
  InterruptibleClock(Clock& clock, const Interrupt& interrupt)
      : InterruptibleClock(clock, &interrupt) {}
  // `interrupt` may be null; then waits are not interruptible. All references must outlive the clock.
  InterruptibleClock(Clock& clock, const Interrupt* interrupt)
      : clock_(clock), interrupt_(interrupt) {}
  Time now() const override { return clock_.now(); }
  Result<void> sleep_until(Time t) override {
    while (true) {
      if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
      const Time next = std::min(t, clock_.now() + kInterruptSlice);
      KAZ_TRY(clock_.sleep_until(next));
      if (next == t) return {};
    }
  }

 private:
  Clock& clock_;
  const Interrupt* interrupt_;
};

class InterruptibleLink final : public Link {
 public:
  // The deadlines of read() must be times of `clock`. All references must outlive the link.
  InterruptibleLink(Link& link, const Clock& clock, const Interrupt& interrupt)
      : InterruptibleLink(link, clock, &interrupt) {}
  InterruptibleLink(Link& link, const Clock& clock, const Interrupt* interrupt)
      : link_(link), clock_(clock), interrupt_(interrupt) {}
  std::string name() const override { return link_.name(); }
  Time byte_time() const override { return link_.byte_time(); }
  Result<void> set_baud(int baud) override { return link_.set_baud(baud); }
  Result<void> write(std::span<const std::uint8_t> bytes) override { return link_.write(bytes); }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    while (true) {
      if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
      const Time next = std::min(deadline, clock_.now() + kInterruptSlice);
      const std::size_t count = KAZ_TRY(link_.read(bytes, next));
      if (count > 0 || next == deadline) return count;
    }
  }
  Result<void> reopen() override {
    if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
    return link_.reopen();
  }

 private:
  Link& link_;
  const Clock& clock_;
  const Interrupt* interrupt_;
};

}  // namespace kaz::host
