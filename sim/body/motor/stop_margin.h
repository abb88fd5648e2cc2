// Where the mechanical stops of joints are.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

// Mechanical stop beyond the firmware's limit, rad.
constexpr double kStopMargin = 0.0174533;

}  // namespace kaz::sim
