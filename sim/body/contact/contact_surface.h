// What two surfaces do to each other where they touch.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// ERP and softness (ODE's CFM) of contacts and stops are those of steps of this length, s.
constexpr double kErpStep = 1e-3;
// A contact gives back this share of its depth in such a step (ODE's ERP).
constexpr double kContactErp = 0.2;

// Together they are a spring of erp / (kErpStep softness) and a damper of (1 - erp) / softness, which is
// the same thing under a step of another length: with these.
constexpr double erp_for(double step_s, double erp) {
  const double spring = erp * (step_s / kErpStep);
  return spring / (spring + (1 - erp));
}
constexpr double softness_for(double step_s, double erp, double softness) {
  return softness / (erp * (step_s / kErpStep) + (1 - erp));
}

// Depth that is left as it is, so that bodies at rest go on touching, m.
constexpr double kContactLayer = 2e-4;
// Bodies inside each other are not driven apart faster than this, m/s.
constexpr double kContactMaxCorrection = 0.2;

// Of a pair: see Surface.
Surface joined(const Surface& a, const Surface& b);

}  // namespace kaz::sim
