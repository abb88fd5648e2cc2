// What each planner checks before it searches.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/precheck.h"

#include <cmath>
#include <limits>

namespace kaz::plan {
namespace {

// The grid planner numbers cells by 16 headings with 32 bits.
constexpr std::size_t kMaxCells = std::numeric_limits<std::uint32_t>::max() / 16;

}  // namespace

Result<void> check(const Grid& grid, const Pose& start, const Goal& goal, const PlanOptions& o) {
  const auto wrong = [](const std::string& what) { return fail(Fault::usage, "plan: " + what); };
  if (grid.cells_x < 1 || grid.cells_y < 1 || !(grid.cell_m > 0) ||
      grid.state.size() !=
          static_cast<std::size_t>(grid.cells_x) * static_cast<std::size_t>(grid.cells_y))
    return wrong(
        "the grid must have at least one cell, a cell size above 0 m, and one state per cell");
  if (grid.state.size() > kMaxCells) return wrong("the grid has too many cells");
  if (!start.position.allFinite() || !goal.position.allFinite() ||
      !std::isfinite(start.heading_rad) ||
      (goal.heading_rad && !std::isfinite(*goal.heading_rad)) || !grid.corner.allFinite())
    return wrong("a position or heading is not finite");
  if (!(o.turn_s_per_rad > 0) || !(o.go_s_per_m > 0) || !std::isfinite(o.turn_s_per_rad) ||
      !std::isfinite(o.go_s_per_m) || !(o.radius_m >= 0) || !(o.unknown_factor >= 1))
    return wrong(
        "turn_s_per_rad and go_s_per_m must be above 0, radius_m must be at least 0, and "
        "unknown_factor must be at least 1");
  return {};
}

std::optional<NoPath> no_path(const Clearance& clearance, const Pose& start, const Goal& goal) {
  const Grid& grid = clearance.grid();
  const Eigen::Vector2i from = grid.cell(start.position), to = grid.cell(goal.position);
  if (!grid.inside(from.x(), from.y()))
    return NoPath{NoPath::Why::start_outside, start.position, 0};
  if (!grid.inside(to.x(), to.y())) return NoPath{NoPath::Why::goal_outside, goal.position, 0};
  const auto blocked = [&](const Eigen::Vector2i& cell, NoPath::Why why) {
    NoPath none = clearance.narrowest(cell, cell);
    none.why = why;
    return none;
  };
  if (!clearance.free(from.x(), from.y())) return blocked(from, NoPath::Why::start_blocked);
  if (!clearance.free(to.x(), to.y())) return blocked(to, NoPath::Why::goal_blocked);
  if (!clearance.connected(from, to)) return clearance.narrowest(from, to);
  return std::nullopt;
}

}  // namespace kaz::plan
