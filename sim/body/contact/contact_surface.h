// Contact parameters of a pair of surfaces.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// Reference step, s. ERP (error reduction parameter) and softness (ODE's CFM) of contacts and stops are given
// for this step.
constexpr double kErpStep = 1e-3;
// Fraction of the penetration depth that is corrected in a step of kErpStep (ODE's ERP).
constexpr double kContactErp = 0.2;

// ERP and CFM represent a spring k and a damper c (ODE manual, "How to use ERP and CFM"). With the step h
//
//   erp = h k / (h k + c),  cfm = 1 / (h k + c),  k = erp / (kErpStep softness),  c = (1 - erp) / softness
//
// with k in N/m and c in N s/m. The following functions convert ERP and softness, given for kErpStep, to a
// step of step_s with the same spring and damper.
constexpr double erp_for(double step_s, double erp) {
  const double spring = erp * (step_s / kErpStep);
  return spring / (spring + (1 - erp));
}
constexpr double softness_for(double step_s, double erp, double softness) {
  return softness / (erp * (step_s / kErpStep) + (1 - erp));
}

// Depth of penetration that is not corrected, so that resting bodies keep their contacts, m.
constexpr double kContactLayer = 2e-4;
// Maximum velocity at which penetrating bodies are separated, m/s.
constexpr double kContactMaxCorrection = 0.2;

// Returns the combined parameters of a pair of surfaces. The rules are documented at Surface.
inline Surface joined(const Surface& a, const Surface& b) {
  const Surface& livelier = a.restitution >= b.restitution ? a : b;
  return {.mu = std::min(a.mu, b.mu),
          .softness = a.softness + b.softness,
          .restitution = livelier.restitution,
          .bounce_threshold = livelier.bounce_threshold,
          .rolling_resistance = std::max(a.rolling_resistance, b.rolling_resistance)};
}

}  // namespace kaz::sim
