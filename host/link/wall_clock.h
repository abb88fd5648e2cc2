// The clock of a real robot: CLOCK_MONOTONIC.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/interrupt.h"
#include "host/link/link.h"

namespace kaz::host {

class WallClock final : public Clock {
 public:
  // `interrupt` may be null; else it must outlive the clock.
  explicit WallClock(const Interrupt* interrupt = nullptr) : interrupt_(interrupt) {}

  // Nanoseconds on CLOCK_MONOTONIC, the scale of camera_stream.hpp's exposure times.
  Time now() const override;
  // Fails only when interrupted, and then without waiting any longer.
  Result<void> sleep_until(Time t) override;

 private:
  const Interrupt* interrupt_;
};

}  // namespace kaz::host
