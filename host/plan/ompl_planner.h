// A second planner: ABIT* of OMPL, which samples poses instead of cells and headings.
// SPDX-License-Identifier: Apache-2.0
//
// ABIT* (Strub and Gammell, "Advanced BIT* (ABIT*): sampling-based planning with advanced graph-search
// techniques", ICRA 2020) draws batches of poses and searches the graph of each pose and its nearest ones for
// the fastest path, with the estimate that the grid planner uses. An edge is a turn towards the other pose, a
// straight line and a turn to the other's heading; its cost is time, in one direction only. Whether it is
// free is checked every half cell. The path found is straightened as the grid planner's.
//
// It ends after a number of batches, or with a path that no other can be faster than. No clock is read: the
// same seed gives the same path.
#pragma once

#include <cstdint>
#include <memory>

#include "host/plan/plan.h"

namespace kaz::plan {

struct OmplOptions {
  std::uint64_t seed = 1;
  int batches = 3;              // at most, 1 or more: more take longer and find faster paths
  int batches_until_found = 6;  // at most, while there is no path yet
  int batch_size = 100;         // poses, 1 or more
};

// Its plan() has one more error (usage): turns of 45 degrees (any_heading off) are the grid planner's alone;
// and one more answer, NoPath::Why::not_found. One planner may be used by one thread at a time.
// Fails where Kaz was built without OMPL (environment), and for options out of their range (usage).
Result<std::unique_ptr<Planner>> make_ompl_planner(const OmplOptions& options = {});

}  // namespace kaz::plan
