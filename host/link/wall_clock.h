// Real-time clock for real robots: CLOCK_MONOTONIC.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/interrupt.h"
#include "host/link/link.h"

namespace kaz::host {

class WallClock final : public Clock {
 public:
  // `interrupt` may be null; else it must outlive the clock.
  explicit WallClock(const Interrupt* interrupt = nullptr) : interrupt_(interrupt) {}

  // Returns CLOCK_MONOTONIC, which is also the time scale of the exposure times in camera_stream.hpp.
  Time now() const override;
  // Fails only if interrupted; an interrupt ends the wait at once.
  Result<void> sleep_until(Time t) override;

 private:
  const Interrupt* interrupt_;
};

}  // namespace kaz::host
