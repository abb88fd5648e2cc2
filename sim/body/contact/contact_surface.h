// Contact parameters of a pair of surfaces.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// Reference step size, s. The ERP (error reduction parameter) and the softness (ODE's CFM) of contacts and
// joint stops are given for this step size.
constexpr double kErpStep = 1e-3;
// Fraction of the penetration depth that the solver corrects in a step of kErpStep (ODE's ERP).
constexpr double kContactErp = 0.2;

// ERP and CFM represent a spring k and a damper c (ODE manual, "How to use ERP and CFM"). The formulas for a
// step size h are:
//
//   erp = h k / (h k + c),  cfm = 1 / (h k + c),  k = erp / (kErpStep softness),  c = (1 - erp) / softness
//
// with k in N/m and c in N s/m. The following functions convert ERP and softness from the step size kErpStep
// to the step size step_s. The conversion does not change the spring k and the damper c.
constexpr double erp_for(double step_s, double erp) {
  const double spring = erp * (step_s / kErpStep);
  return spring / (spring + (1 - erp));
}
constexpr double softness_for(double step_s, double erp, double softness) {
  return softness / (erp * (step_s / kErpStep) + (1 - erp));
}

// The solver does not correct a penetration up to this depth (m). Therefore resting bodies stay in contact.
constexpr double kContactLayer = 2e-4;
// Maximum velocity (m/s) at which the solver separates penetrating bodies.
constexpr double kContactMaxCorrection = 0.2;

// Returns the contact parameters of a pair of surfaces. The comment of Surface (rigid_link.h) states the
// rules.
inline Surface joined(const Surface& a, const Surface& b) {
  const Surface& livelier = a.restitution >= b.restitution ? a : b;
  return {.mu = std::min(a.mu, b.mu),
          .softness = a.softness + b.softness,
          .restitution = livelier.restitution,
          .bounce_threshold = livelier.bounce_threshold,
          .rolling_resistance = std::max(a.rolling_resistance, b.rolling_resistance)};
}

}  // namespace kaz::sim
