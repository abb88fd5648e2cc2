// Degrees, where people write and read them; angles are in radians everywhere else.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace kaz {

inline constexpr double kDegree = std::numbers::pi / 180;  // rad

}  // namespace kaz
