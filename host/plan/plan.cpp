// What planners have in common.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/plan.h"

#include <cmath>
#include <cstdio>

#include "host/plan/clearance.h"

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
    for (int y = first; y <= last; ++y) grid.state.push_back(map.certain(x, y));
  return grid;
}

void forget_specks(Grid& grid, int cells, const Eigen::Vector2d& from, double beyond_m) {
  std::vector<bool> visited(grid.state.size(), false);
  std::vector<Eigen::Vector2i> speck;
  for (int x = 0; x < grid.cells_x; ++x) {
    for (int y = 0; y < grid.cells_y; ++y) {
      if (grid.at(x, y) != map::CellState::obstacle || visited[grid.index(x, y)]) continue;
      // Flood fill; `speck` is the queue, too.
      speck.assign(1, {x, y});
      visited[grid.index(x, y)] = true;
      bool far = true;
      for (std::size_t i = 0; i < speck.size(); ++i) {
        const Eigen::Vector2i at = speck[i];
        far = far && (grid.middle(at.x(), at.y()) - from).norm() > beyond_m;
        for (int side = 0; side < 9; ++side) {
          const int nx = at.x() + side % 3 - 1, ny = at.y() + side / 3 - 1;
          if (grid.at(nx, ny) != map::CellState::obstacle || visited[grid.index(nx, ny)]) continue;
          visited[grid.index(nx, ny)] = true;
          speck.emplace_back(nx, ny);
        }
      }
      if (!far || speck.size() >= static_cast<std::size_t>(cells)) continue;
      for (const Eigen::Vector2i& at : speck)
        grid.state[grid.index(at.x(), at.y())] = map::CellState::unknown;
    }
  }
}

std::optional<Eigen::Vector2d> nearest_reachable(const Grid& grid, const Eigen::Vector2d& from,
                                                 const Eigen::Vector2d& to,
                                                 const PlanOptions& options) {
  const Clearance clearance(grid, options);
  const auto cell = clearance.nearest_connected(grid.cell(from), to);
  if (!cell) return std::nullopt;
  return grid.middle(cell->x(), cell->y());
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
      return place(
          "the robot is %.2f m from an obstacle at (%.3f, %.3f); the robot needs %.2f m to turn");
    case NoPath::Why::goal_blocked:
      return place(
          "the goal is %.2f m from an obstacle at (%.3f, %.3f); the robot needs a distance of at "
          "least %.2f m");
    case NoPath::Why::not_found:
      return place(
          "the planner found no path within its sample limit. The widest way to the goal passes "
          "%.2f m from the obstacle at (%.3f, %.3f)");
    case NoPath::Why::enclosed:
      // Where all ways are closed, none is the widest.
      if (none.clear_m <= 0) return "obstacles close off the goal on all sides";
      break;
  }
  return place(
      "the widest way to the goal passes %.2f m from the obstacle at (%.3f, %.3f); the robot needs "
      "a distance of at least %.2f m");
}

}  // namespace kaz::plan
