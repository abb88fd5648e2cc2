// Replaces corners of a path by straight lines, and makes its legs. Internal to host/plan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/plan/clearance.h"

namespace kaz::plan {

// Returns the fastest path from start to goal by straight lines between points of the way through
// `corners`, in order. Without any_heading, it passes all of them. `corners`: points from the start to the
// goal, each reached from the one before by a free straight line. They are cell centers in the grid planner
// and poses in the OMPL planner.
Path straighten(const Clearance& clearance, const Pose& start, const Goal& goal,
                const PlanOptions& options, const std::vector<Eigen::Vector2d>& corners);

}  // namespace kaz::plan
