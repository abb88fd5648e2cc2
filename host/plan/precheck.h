// What each planner checks before it searches. Internal to host/plan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/plan/clearance.h"

namespace kaz::plan {

// The errors of Planner::plan().
Result<void> check(const Grid& grid, const Pose& start, const Goal& goal,
                   const PlanOptions& options);

// Why no planner finds a path from start to goal. Nothing: there is one, at least from cell to cell, across
// corners of cells, too.
std::optional<NoPath> no_path(const Clearance& clearance, const Pose& start, const Goal& goal);

}  // namespace kaz::plan
