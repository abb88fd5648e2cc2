// Kinds of worlds to walk in: draws obstacles and goal, and finds the shortest walk.
// SPDX-License-Identifier: Apache-2.0
//
// Frame: between the feet of the robot at its start; x ahead, y left. Units m, rad.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "host/plan/plan.h"
#include "shared/base/result.hpp"
#include "tools/app/evaluate/obstacle.h"
#include "tools/trials/statistics.h"

namespace kaz::tools {

// Range of a uniform distribution.
using trials::Interval;

enum class WorldKind {
  clutter,
  corridor,
  slalom,
  u_trap,
  low_step,
  thin_poles,
  table_edge,
  patterned_floor,
  plain_floor,
  moving_box,
  dark,
  two_balls
};
struct WorldKindInfo {
  WorldKind kind;
  const char* name;
  const char* text;   // contents, and what density changes
  double min_goal_m;  // least distance of a drawn goal, so that the structure fits
};
// All kinds, in the order of the enumeration.
std::span<const WorldKindInfo> world_kinds();
const char* to_string(WorldKind kind);
// Returns whether the world has scattered boxes and cans. LayoutRange::max_obstacles and the density set
// their number.
bool has_clutter(WorldKind kind);
// Parses names, or "all". Fails (usage) for an unknown name; the message lists all names.
Result<std::vector<WorldKind>> parse_world_kinds(const std::vector<std::string>& names);

// Returns "sparse", "medium" or "dense", the thirds of 0 to 1.
const char* density_grade(double density);

// Part of a table top, centered at x, y.
struct Slab {
  double x_m = 0, y_m = 0, yaw_rad = 0, length_m = 1, width_m = 1;
};

struct Layout {
  std::vector<Obstacle> obstacles = {};
  std::vector<Slab> table = {};  // The robot stands on it. Empty: an infinite floor.
  Eigen::Vector2d goal{0, 0};
  std::optional<double> goal_heading_rad = {};
  double density = 0;  // 0 to 1
};

// Ranges from which layouts are drawn.
struct LayoutRange {
  double bearing_deg = 90;  // largest bearing of the goal to either side
  Interval goal_distance_m{0.7, 1.5};
  Interval density{0, 1};
  int max_obstacles = 8;  // for kinds with clutter; the least number is half of it
};

// Draws a layout, which may have no path to the goal (least_seconds()). With `ball_is_goal` the goal has no
// heading. Then clutter and two_balls put it at `ball`. The other kinds draw it anyway, because their
// structures need room.
Layout draw_layout(WorldKind kind, const LayoutRange& range, std::uint64_t seed, bool ball_is_goal,
                   const Eigen::Vector2d& ball);

class Dice;
// Draws a box, can or large ball, `near_m` to `far_m` from the start in any direction. `rgb`: its color, that
// of the target ball; null: a color that no ball has. Distractor balls never have the target ball's radius.
Obstacle draw_prop(Dice& dice, double near_m, double far_m, const std::array<double, 3>* rgb);

// Returns the true floor after all slides, in a square of 2 `reach_m` around the start. Obstacles, and the
// area beside the table, are obstacle cells.
plan::Grid true_grid(const Layout& layout, double reach_m);
// Returns the `reach_m` for planning: it contains start and goal, with room to walk around obstacles between
// them.
double reach_of(const Layout& layout);
// Returns the shortest walking time from start to goal, in s; nullopt if there is no path. Start and goal
// must be free before and after the slides. A robot of 20 cm radius must find a path. This exceeds the
// robot's own planning radius, so that a drawn path does not look blocked to it. The time is for the robot's
// own planning radius.
Result<std::optional<double>> least_seconds(const Layout& layout);

}  // namespace kaz::tools
