// Ratio of the physics step to the firmware's tick.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/step_ratio.h"

#include <cmath>
#include <cstdio>

namespace kaz::sim {

Result<StepRatio> step_ratio(double step_ms) {
  for (const StepRatio ratio : {StepRatio{8, 1}, StepRatio{4, 1}, StepRatio{2, 1}, StepRatio{1, 1},
                                StepRatio{1, 2}, StepRatio{1, 4}}) {
    // The world's step in s is converted twice: tolerance for rounding.
    const double length = static_cast<double>(ratio.ticks_a_step) / ratio.steps_a_tick;
    if (std::abs(step_ms - length) < 1e-9) return ratio;
  }
  char number[32];
  std::snprintf(number, sizeof number, "%g", step_ms);
  return fail(Fault::usage, std::string("a physics step of ") + number +
                                " ms does not fit the firmware's tick of 1 ms; give 0.125, 0.25, "
                                "0.5, 1, 2 or 4");
}

}  // namespace kaz::sim
