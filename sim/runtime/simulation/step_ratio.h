// Ratio of the physics step to the firmware's tick.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"

namespace kaz::sim {

// Number of physics steps per tick of 1 ms, and number of ticks per physics step. At least one of the two
// numbers is 1.
struct StepRatio {
  int steps_a_tick = 1;
  int ticks_a_step = 1;
};

// Computes the ratio. Returns Fault::usage if `step_ms` is not 0.125, 0.25, 0.5, 1, 2 or 4.
Result<StepRatio> step_ratio(double step_ms);

}  // namespace kaz::sim
