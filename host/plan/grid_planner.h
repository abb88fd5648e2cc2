// The reference planner: A* over cells and 16 headings.
// SPDX-License-Identifier: Apache-2.0
//
// A state is a cell and one of 16 headings, those of the steps (1, 0), (2, 1), (1, 1), (1, 2) and
// their reflections. It goes on by a step ahead or by a turn to the next heading on either side;
// the cost is time. The estimate of what is left is the time without obstacles: turn towards the
// goal, go, turn to the goal's heading. No way takes less: a part of it heads to the goal, or
// parts of it to both sides of the goal, and its length is at least the distance. So the path
// found is the fastest on this graph.
//
// Afterwards (any_heading) corners are left out and joined by straight lines of any heading, as far as these
// are free, by dynamic programming over pairs of corners with the same cost.
#pragma once

#include <memory>

#include "host/plan/plan.h"

namespace kaz::plan {

enum class Search { astar, exhaustive };  // exhaustive: without the estimate, to judge it

// Keeps its memory between calls; one for each thread.
std::unique_ptr<Planner> make_grid_planner(Search search = Search::astar);

}  // namespace kaz::plan
