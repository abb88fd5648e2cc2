// Ctrl-C and termination end a program in order: motors off, files closed, links removed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/interrupt.h"
#include "host/link/link.h"

namespace kaz::tools {

// While it lives SIGINT, SIGTERM and SIGHUP request `interrupt`. One at a time in a process. A
// second signal ends the program at once.
class InterruptSignals {
 public:
  explicit InterruptSignals(host::Interrupt& interrupt);
  ~InterruptSignals();
  InterruptSignals(const InterruptSignals&) = delete;
  InterruptSignals& operator=(const InterruptSignals&) = delete;
};

// A clock whose waiting ends with an error once the interrupt is requested: Ctrl-C works in simulated time
// as in real time.
class InterruptibleClock final : public host::Clock {
 public:
  InterruptibleClock(host::Clock& clock, const host::Interrupt& interrupt)
      : clock_(clock), interrupt_(interrupt) {}
  Time now() const override { return clock_.now(); }
  Result<void> sleep_until(Time t) override {
    if (interrupt_.requested()) return tl::unexpected(host::Interrupt::error());
    return clock_.sleep_until(t);
  }

 private:
  host::Clock& clock_;
  const host::Interrupt& interrupt_;
};

}  // namespace kaz::tools
