// Writes a URDF with other joint limits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// New limits of a joint, rad; of a prismatic joint, m. A joint whose `lower` is not below `upper` becomes
// fixed.
struct JointRange {
  std::string joint;
  double lower = 0, upper = 0;
};

// Returns the robot in the file `path` (URDF or MJCF) as a URDF in which the joints in `ranges` have these
// limits. Continuous joints become revolute joints. Everything else of a URDF is unchanged, except white
// space. Fails (usage) if the file cannot be read, is not XML, or lacks one of the joints.
Result<std::string> urdf_with_limits(const std::string& path,
                                     const std::vector<JointRange>& ranges);

}  // namespace kaz::sim
