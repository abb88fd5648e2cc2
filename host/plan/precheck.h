// Common checks of all planners, executed before each search. Internal to host/plan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/plan/clearance.h"

namespace kaz::plan {

// Returns the errors of Planner::plan().
Result<void> check(const Grid& grid, const Pose& start, const Goal& goal,
                   const PlanOptions& options);

// Returns the reason why no planner can find a path from start to goal. Returns no reason if steps between
// neighboring free cells (sides or corners) connect start and goal.
std::optional<NoPath> no_path(const Clearance& clearance, const Pose& start, const Goal& goal);

}  // namespace kaz::plan
