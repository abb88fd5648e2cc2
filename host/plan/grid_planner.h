// Reference planner: A* over cells and 16 headings.
// SPDX-License-Identifier: Apache-2.0
//
// A state is a cell and one of 16 headings. The headings are the directions of the steps (1, 0), (2, 1), (1,
// 1), (1, 2) and their reflections. The successors of a state are reached by a step ahead, or by a turn to
// the next heading on either side. The cost is time.
//
// The heuristic is the time without obstacles: turn toward the goal, walk to the goal, turn to the goal's
// heading. The heuristic never exceeds the time of a path, for two reasons. First, no path turns less than
// the heuristic assumes. A path with a step straight toward the goal turns to the goal's direction. A path
// without such a step turns past the goal's direction. Second, every path is at least as long as the distance
// to the goal. So A* finds the fastest path on this graph.
//
// If PlanOptions::any_heading is true, straight lines of any heading then replace parts of the path. A line
// must be free of obstacles. Dynamic programming over pairs of corners, with time as cost, selects the lines.
#pragma once

#include <memory>

#include "host/plan/plan.h"

namespace kaz::plan {

// The exhaustive search uses no heuristic. Tests compare both searches.
enum class Search { astar, exhaustive };

// The planner keeps allocated memory between calls. Use a separate planner in each thread.
std::unique_ptr<Planner> make_grid_planner(Search search = Search::astar);

}  // namespace kaz::plan
