// Measures speed and reliability of the link to a board: group `link` of measurements.def.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/bench/board_line.h"
#include "hil/bench/measurement.h"

namespace kaz::hil {

struct LinkBenchOptions {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  int round_trips = 1000;
  // Duration of the control cycles, which are sent as fast as the link allows.
  Time cycle_time = std::chrono::seconds(5);
  Time stream_time = std::chrono::seconds(10);  // time with telemetry every 10 ms
  // Whether to switch the joints on and hold them in place. If false, no motor is on, and the board refuses
  // the targets of the cycles. The load on the line stays the same, because a refusal is as long as an
  // acknowledgment.
  bool allow_motion = false;
  std::uint64_t seed = 1;  // seed of the random pauses between round trips
  BenchProgress progress;
};

// Errors (environment): no board; the board's motors are on; the link is lost; the board was reset during the
// bench.
Result<void> bench_link(host::Link& link, host::Clock& clock, const LinkBenchOptions& options,
                        BenchJudge& judge);

}  // namespace kaz::hil
