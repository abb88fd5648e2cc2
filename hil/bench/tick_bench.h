// Measures duration and jitter of a board's ticks: group `tick` of measurements.def.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/bench/board_line.h"
#include "hil/bench/measurement.h"

namespace kaz::hil {

struct TickBenchOptions {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  // Time with telemetry only. The first half of `quiet_time` is before `load_time`, the second half is after
  // `load_time`.
  Time quiet_time = std::chrono::seconds(10);
  Time load_time = std::chrono::seconds(10);  // time with control cycles of 18 joints at 100 Hz
  bool allow_motion = false;                  // see LinkBenchOptions::allow_motion
  bool one_clock = false;                     // whether board and bench share one clock
  BenchProgress progress;
};

// Returns the same errors as bench_link().
Result<void> bench_tick(host::Link& link, host::Clock& clock, const TickBenchOptions& options,
                        BenchJudge& judge);

}  // namespace kaz::hil
