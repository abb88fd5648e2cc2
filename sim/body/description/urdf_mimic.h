// Resolves the <mimic> elements of a URDF.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "sim/body/description/urdf_check.h"

namespace kaz::sim {

// Range of a resolved multiplier's magnitude.
inline constexpr double kSmallestRatio = 1e-3, kLargestRatio = 1e3;

// Fills Urdf::mimics. A chain of <mimic> ends at a joint with a motor. Calls `object` for each error: a
// missing attribute, an unknown or fixed joint, a cycle, or a ratio out of range.
void resolve_mimics(
    Urdf& urdf, const std::function<void(const tinyxml2::XMLElement&, const std::string&)>& object);

}  // namespace kaz::sim
