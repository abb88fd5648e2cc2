// How steps of the world and ticks of the firmware go together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"

namespace kaz::sim {

// Steps of the world in a tick of 1 ms, or ticks in a step: one of the two is 1.
struct StepRatio {
  int steps_a_tick = 1;
  int ticks_a_step = 1;
};

// Errors: another length than 0.125, 0.25, 0.5, 1, 2 or 4 ms.
Result<StepRatio> step_ratio(double step_ms);

}  // namespace kaz::sim
