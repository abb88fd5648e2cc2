// Kinds of worlds to walk in. Draws obstacles and goal of a world, and computes the shortest walking time.
// SPDX-License-Identifier: Apache-2.0
//
// Coordinate frame: origin between the feet of the robot at the start; x ahead, y left. Units: m, rad.
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
#include "tools/eval/obstacle.h"
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
  const char* text;   // contents of the world, and the effect of the density
  double min_goal_m;  // smallest distance of a drawn goal; the structure needs this room
};
// Returns all kinds, in the order of the enumeration.
std::span<const WorldKindInfo> world_kinds();
const char* to_string(WorldKind kind);
// Returns whether the world has scattered boxes and cans. LayoutRange::max_obstacles and the density
// determine the number of boxes and cans.
bool has_clutter(WorldKind kind);
// Parses names, or "all". Fails (usage) for an unknown name; the message lists all names.
Result<std::vector<WorldKind>> parse_world_kinds(const std::vector<std::string>& names);

// Returns "sparse" for a density in the lowest third of 0 to 1, "medium" in the middle third, "dense" in the
// highest third.
const char* density_grade(double density);

// Rectangular part of a table top. x_m and y_m: center of the part.
struct Slab {
  double x_m = 0, y_m = 0, yaw_rad = 0, length_m = 1, width_m = 1;
};

struct Layout {
  std::vector<Obstacle> obstacles = {};
  // Parts of the table top on which the robot stands; empty: the floor is infinite.
  std::vector<Slab> table = {};
  Eigen::Vector2d goal{0, 0};
  std::optional<double> goal_heading_rad = {};
  double density = 0;  // 0 to 1
};

// Ranges from which layouts are drawn.
struct LayoutRange {
  // Largest angle between the goal's direction and straight ahead, to either side.
  double bearing_deg = 90;
  Interval goal_distance_m{0.7, 1.5};
  Interval density{0, 1};
  // For kinds with clutter: largest number of boxes and cans; the smallest number is half of this value.
  int max_obstacles = 8;
};

// Draws a layout. The layout may have no path to the goal; least_seconds() checks this. With `ball_is_goal`
// the goal has no heading. In this case the kinds clutter and two_balls put the goal at `ball`. The other
// kinds draw the goal, because their structures need room.
Layout draw_layout(WorldKind kind, const LayoutRange& range, std::uint64_t seed, bool ball_is_goal,
                   const Eigen::Vector2d& ball);

class Dice;
// Draws a distractor: a box, can or large ball, `near_m` to `far_m` from the start in any direction. If `rgb`
// (the color of the target ball) is not null, the distractor has this color. If `rgb` is null, the distractor
// has a color that no ball has. Distractor balls never have the target ball's radius.
Obstacle draw_prop(Dice& dice, double near_m, double far_m, const std::array<double, 3>* rgb);

// Returns a true map of a square around the start, with sides of 2 `reach_m`. The map shows the world after
// all obstacles have slid. Cells on obstacles, and cells beside the table, are obstacle cells.
plan::Grid true_grid(const Layout& layout, double reach_m);
// Returns a `reach_m` for which true_grid() contains start and goal, with room to walk around the obstacles
// between them.
double reach_of(const Layout& layout);
// Returns the shortest walking time from start to goal, in s; nullopt if there is no path. A path exists only
// if start and goal are free before and after all obstacles have slid. A robot with a radius of 20 cm must
// also fit through. This radius is larger than the robot's planning radius, so that a drawn path does not
// look blocked to the robot. The returned time is for the robot's planning radius.
Result<std::optional<double>> least_seconds(const Layout& layout);

}  // namespace kaz::tools
