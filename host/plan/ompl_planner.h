// Second planner: ABIT* of OMPL, which samples poses instead of cells and headings.
// SPDX-License-Identifier: Apache-2.0
//
// ABIT* draws batches of random poses. The planner connects each pose with the nearest poses and searches
// this graph for the fastest path. Source: Strub and Gammell, "Advanced BIT* (ABIT*): sampling-based planning
// with advanced graph-search techniques", ICRA 2020. This implementation uses the heuristic of the grid
// planner. An edge between two poses is a turn toward the second pose, a straight line, and a turn to the
// heading of the second pose. The cost of an edge is time. The two directions of an edge can have different
// costs. An edge is checked for obstacles every half cell. At the end, straight lines replace parts of the
// path, as in the grid planner.
//
// The search ends after a number of batches, or when no faster path can exist. The search reads no clock, so
// the same seed gives the same path.
#pragma once

#include <cstdint>
#include <memory>

#include "host/plan/plan.h"

namespace kaz::plan {

struct OmplOptions {
  std::uint64_t seed = 1;
  // Number of batches after which the search ends if a path has been found; 1 or more. More batches take
  // longer and find faster paths.
  int batches = 3;
  // Number of batches after which the search ends even if no path has been found. If this number is smaller
  // than `batches`, `batches` is used instead.
  int batches_until_found = 6;
  int batch_size = 100;  // number of poses in a batch, 1 or more
};

// Fails if Kaz was built without OMPL (environment), or if options are out of range (usage).
//
// The planner's plan() also fails (usage) if PlanOptions::any_heading is false, because only the grid planner
// can be restricted to turns of 45 degrees. If OMPL fails, plan() returns Fault::failed. If plan() finds no
// path, the reason may be NoPath::Why::not_found. Only one thread at a time may use a planner.
Result<std::unique_ptr<Planner>> make_ompl_planner(const OmplOptions& options = {});

}  // namespace kaz::plan
