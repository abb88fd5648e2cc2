// Conversion of degrees for input and output. All other angles are in radians.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace kaz {

inline constexpr double kDegree = std::numbers::pi / 180;  // rad

}  // namespace kaz
