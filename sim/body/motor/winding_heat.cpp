// Heat of a motor: winding, case and air, one after the other.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/motor/winding_heat.h"

namespace kaz::sim {

void WindingHeat::take(double copper_watts, double friction_watts, double step_s) {
  if (params_.winding_heat_capacity == 0) return;
  const double to_case = (winding_ - case_) / params_.winding_to_case;
  const double to_air = (case_ - params_.air_celsius) / params_.case_to_air;
  winding_ += step_s * (copper_watts - to_case) / params_.winding_heat_capacity;
  case_ += step_s * (to_case + friction_watts - to_air) / params_.case_heat_capacity;
}

}  // namespace kaz::sim
