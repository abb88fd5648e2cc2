// Thermal model of a motor: winding, case and ambient air in series.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/motor/winding_heat.h"

namespace kaz::sim {

// One explicit Euler step of the two equations in winding_heat.h; both heat flows are taken from the old
// temperatures. Stable for step_s far below the time constant C_w R_wc (seconds).
void WindingHeat::take(double copper_watts, double friction_watts, double step_s) {
  if (params_.winding_heat_capacity == 0) return;
  const double to_case = (winding_ - case_) / params_.winding_to_case;
  const double to_air = (case_ - params_.air_celsius) / params_.case_to_air;
  winding_ += step_s * (copper_watts - to_case) / params_.winding_heat_capacity;
  case_ += step_s * (to_case + friction_watts - to_air) / params_.case_heat_capacity;
}

}  // namespace kaz::sim
