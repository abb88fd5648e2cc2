// All 18 targets out and all 18 positions back, at a given rate or as fast as the wire allows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/robot/robot.h"

namespace kaz::lockstep {

struct WireLoad {
  double rate_hz = 0;                  // postures that came
  double share_out = 0, share_in = 0;  // of the wire, 0..1
  double oldest_s = 0;     // longest from when targets left to when their posture was there
  std::uint64_t late = 0;  // cycles due while earlier ones filled the window
  std::uint64_t retries = 0;
};

// Switches all joints on and lets them swing by 0.05 rad about where they stand. `rate_hz` 0: the
// next targets leave as soon as the window has room.
Result<WireLoad> run_wire_load(host::Robot& robot, Time byte_time, double rate_hz, Time duration);

}  // namespace kaz::lockstep
