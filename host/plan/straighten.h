// Replaces corners of a path by straight lines, and computes the legs of the new path. Internal to host/plan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/plan/clearance.h"

namespace kaz::plan {

// Shortens the way through `corners`. The new path consists of straight lines between points of this way, in
// the same order. Returns the fastest such path from start to goal. If any_heading is false, the path passes
// all corners. `corners`: points from the start to the goal; the straight line between two consecutive points
// must be free. The grid planner passes cell centers, the OMPL planner passes positions of poses.
Path straighten(const Clearance& clearance, const Pose& start, const Goal& goal,
                const PlanOptions& options, const std::vector<Eigen::Vector2d>& corners);

}  // namespace kaz::plan
