// Ratio of the physics step to the firmware's tick.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"

namespace kaz::sim {

// Physics steps per tick of 1 ms, and ticks per physics step. At least one of them is 1.
struct StepRatio {
  int steps_a_tick = 1;
  int ticks_a_step = 1;
};

// Returns Fault::usage for a step other than 0.125, 0.25, 0.5, 1, 2 or 4 ms.
Result<StepRatio> step_ratio(double step_ms);

}  // namespace kaz::sim
