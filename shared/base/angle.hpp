// Conversion between radians and degrees. Only input and output use degrees.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace kaz {

inline constexpr double kDegree = std::numbers::pi / 180;  // rad

}  // namespace kaz
