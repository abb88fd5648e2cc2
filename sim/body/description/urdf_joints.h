// Checks of a URDF's joints together: <mimic>, and the names of Kaz's joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "sim/body/description/urdf_check.h"

namespace kaz::sim {

// Range of a resolved multiplier's magnitude.
inline constexpr double kSmallestRatio = 1e-3, kLargestRatio = 1e3;

// Receives an element and an error or a note about it.
using UrdfRemark = std::function<void(const tinyxml2::XMLElement&, const std::string&)>;

// Fills Urdf::mimics. A chain of <mimic> ends at a joint with a motor. Calls `object` for each error: a
// missing attribute, an unknown or fixed joint, a cycle, or a ratio out of range.
void resolve_mimics(Urdf& urdf, const UrdfRemark& object);

// Checks the joints with a motor. A robot needs at least one of them. A Kaz must have all joints of the
// board's table, and no others. Call after resolve_mimics().
void check_joint_names(const Urdf& urdf, const UrdfRemark& object);

}  // namespace kaz::sim
