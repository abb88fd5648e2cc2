// A clock that an interrupt stops, so that Ctrl-C works in simulated time as it does in real time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/interrupt.h"
#include "host/link/link.h"

namespace kaz::tools {

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
