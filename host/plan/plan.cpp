// What planners have in common.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/plan.h"

#include <cmath>
#include <cstdio>

namespace kaz::plan {

Grid grid_of(const map::LocalMap& map, double size_m) {
  const int first = std::max(0, map.number(-0.5 * size_m));
  const int last = std::min(map.cells() - 1, map.number(0.5 * size_m));
  Grid grid;
  grid.cells_x = grid.cells_y = last - first + 1;
  grid.cell_m = map.options().cell_m;
  grid.corner.setConstant(map.middle(first) - 0.5 * grid.cell_m);
  grid.state.reserve(static_cast<std::size_t>(grid.cells_x) *
                     static_cast<std::size_t>(grid.cells_y));
  for (int x = first; x <= last; ++x)
    for (int y = first; y <= last; ++y) grid.state.push_back(map.cell(x, y).state);
  return grid;
}

std::string text(const NoPath& none, const PlanOptions& options) {
  char line[200];
  const auto place = [&](const char* format) {
    std::snprintf(line, sizeof line, format, none.clear_m, none.where.x(), none.where.y(),
                  options.radius_m);
    return std::string(line);
  };
  switch (none.why) {
    case NoPath::Why::start_outside:
      return "the robot is not on the map";
    case NoPath::Why::goal_outside:
      return "the goal is not on the map";
    case NoPath::Why::start_blocked:
      return place("the robot is %.2f m from an obstacle at (%.3f, %.3f); it needs %.2f m to turn");
    case NoPath::Why::goal_blocked:
      return place("the goal is %.2f m from an obstacle at (%.3f, %.3f); the robot needs %.2f m");
    case NoPath::Why::enclosed:
      break;
  }
  return place("the widest way has %.2f m to each side at (%.3f, %.3f); the robot needs %.2f m");
}

}  // namespace kaz::plan
