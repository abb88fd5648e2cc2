// Straight lines between corners of a way, and its legs. Internal to host/plan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/plan/clearance.h"

namespace kaz::plan {

// The fastest way from start to goal by straight lines between some of `corners`, in their order; without
// any_heading by all of them. `corners`: middles of cells, from the start's to the goal's, each in a straight
// line that is free from the one before.
Path straighten(const Clearance& clearance, const Pose& start, const Goal& goal,
                const PlanOptions& options, const std::vector<Eigen::Vector2d>& corners);

}  // namespace kaz::plan
