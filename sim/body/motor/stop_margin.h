// Position of the mechanical stops of joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

// Distance from a joint's software limit to its mechanical stop, rad (1 degree).
constexpr double kStopMargin = 0.0174533;

}  // namespace kaz::sim
