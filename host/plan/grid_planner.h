// Reference planner: A* over cells and 16 headings.
// SPDX-License-Identifier: Apache-2.0
//
// A state is a cell and one of 16 headings, those of the steps (1, 0), (2, 1), (1, 1), (1, 2) and their
// reflections. Its successors are a step ahead, and a turn to the next heading on either side. The cost is
// time.
//
// The heuristic is the time without obstacles: turn toward the goal, go, turn to the goal's heading. No
// path takes less: either a part of it heads to the goal, or its parts head to both sides of the goal. Its
// length is at least the distance. So the path found is the fastest on this graph.
//
// Afterwards (any_heading), straight lines of any heading skip corners where they are free. They are chosen
// by dynamic programming over pairs of corners with the same cost.
#pragma once

#include <memory>

#include "host/plan/plan.h"

namespace kaz::plan {

enum class Search { astar, exhaustive };  // exhaustive: without the heuristic, to test it

// The planner keeps its memory between calls. Use one for each thread.
std::unique_ptr<Planner> make_grid_planner(Search search = Search::astar);

}  // namespace kaz::plan
