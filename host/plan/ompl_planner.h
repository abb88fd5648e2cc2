// Second planner: ABIT* of OMPL, which samples poses instead of cells and headings.
// SPDX-License-Identifier: Apache-2.0
//
// ABIT* draws batches of poses and searches the graph of each pose and its nearest ones for the fastest
// path. Source: Strub and Gammell, "Advanced BIT* (ABIT*): sampling-based planning with advanced
// graph-search techniques", ICRA 2020. It uses the heuristic of the grid planner. An edge is a turn toward
// the other pose, a straight line, and a turn to the other's heading. Its cost is time, in one direction
// only. It is checked every half cell to be free. The path found is straightened like that of the grid
// planner.
//
// It ends after a number of batches, or with a path that no other can improve. It reads no clock, so the same
// seed gives the same path.
#pragma once

#include <cstdint>
#include <memory>

#include "host/plan/plan.h"

namespace kaz::plan {

struct OmplOptions {
  std::uint64_t seed = 1;
  // Maximum number, 1 or more. More batches take longer and find faster paths.
  int batches = 3;
  int batches_until_found = 6;  // maximum number without a path
  int batch_size = 100;         // poses in a batch, 1 or more
};

// Errors: Kaz was built without OMPL (environment), or options are out of range (usage).
//
// The planner's plan() also fails (usage) without any_heading, because only the grid planner turns by 45
// degrees, and (failed) if OMPL fails. It may return NoPath::Why::not_found. Only one thread at a time may
// use a planner.
Result<std::unique_ptr<Planner>> make_ompl_planner(const OmplOptions& options = {});

}  // namespace kaz::plan
