// Speed and reliability of the link to a board: the group `link` of measurements.def.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/bench/board_line.h"
#include "hil/bench/measurement.h"

namespace kaz::hil {

struct LinkBenchOptions {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  int round_trips = 1000;
  Time cycle_time = std::chrono::seconds(5);    // of control cycles as fast as the link takes them
  Time stream_time = std::chrono::seconds(10);  // of telemetry every 10 ms
  // Joints on, held where they are. Without it the board refuses the targets of the cycles, which
  // are as long, and no motor is on.
  bool allow_motion = false;
  std::uint64_t seed = 1;  // of the pauses between round trips
  BenchProgress progress;
};

// Errors: there is no board, its motors are on, the link is gone, the board was reset meanwhile
// (environment).
Result<void> bench_link(host::Link& link, host::Clock& clock, const LinkBenchOptions& options,
                        BenchJudge& judge);

}  // namespace kaz::hil
