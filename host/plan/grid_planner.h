// Reference planner: A* over cells and 16 headings.
// SPDX-License-Identifier: Apache-2.0
//
// A state is a cell and one of 16 headings. The headings are the directions of the steps (1, 0), (2, 1), (1,
// 1), (1, 2) and their reflections. The successors of a state are reached by a step ahead, or by a turn to
// the next heading on either side. The cost is time.
//
// The heuristic is the time without obstacles: turn toward the goal, walk to the goal, turn to the goal's
// heading. The heuristic never exceeds the time of a path, for two reasons. First, on every path, the robot's
// heading reaches or passes the direction of the goal. So the turns of a path take at least as long as the
// turns in the heuristic. Second, every path is at least as long as the distance to the goal. So A* finds the
// fastest path on this graph.
//
// If PlanOptions::any_heading is true, straight lines of any heading then replace parts of the path. A line
// must be free of obstacles. Dynamic programming over pairs of points on the path selects the lines that take
// the least time.
#pragma once

#include <memory>

#include "host/plan/plan.h"

namespace kaz::plan {

// The exhaustive search uses no heuristic. Tests compare the results of `astar` and `exhaustive`.
enum class Search { astar, exhaustive };

// The planner keeps allocated memory between calls. Use a separate planner in each thread.
std::unique_ptr<Planner> make_grid_planner(Search search = Search::astar);

}  // namespace kaz::plan
