// What two surfaces do to each other where they touch.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/body/rigid_link.h"

namespace kaz::sim {

// A contact gives back this share of its depth each millisecond step (ODE's ERP).
constexpr double kContactErp = 0.2;
// Depth that is left as it is, so that bodies at rest go on touching, m.
constexpr double kContactLayer = 2e-4;
// Bodies inside each other are not driven apart faster than this, m/s.
constexpr double kContactMaxCorrection = 0.2;

// Of a pair: see Surface.
Surface joined(const Surface& a, const Surface& b);

}  // namespace kaz::sim
