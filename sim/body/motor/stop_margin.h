// Position of the mechanical stops of joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

// Distance from the software limit of a joint to the mechanical stop, rad (1 degree).
constexpr double kStopMargin = 0.0174533;

}  // namespace kaz::sim
