// Kinds of worlds to walk in: what stands where, and where the goal is.
// SPDX-License-Identifier: Apache-2.0
//
// Frame: from between the feet of the robot at its start; x ahead, y left. Units m, rad.
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

// From where to where something is drawn, evenly.
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
  const char* text;   // what is in it, and what density changes
  double min_goal_m;  // the goal is never drawn nearer than that: else it does not fit
};
// In the order of the enumeration.
std::span<const WorldKindInfo> world_kinds();
const char* to_string(WorldKind kind);
// Boxes and cans stand about, as many as LayoutRange::max_obstacles and the density make them.
bool has_clutter(WorldKind kind);
// Names, or "all". Errors (usage): none of them, with the names that there are.
Result<std::vector<WorldKind>> parse_world_kinds(const std::vector<std::string>& names);

// "sparse", "medium", "dense": thirds of 0..1.
const char* density_grade(double density);

// A part of a table top, its middle at x, y.
struct Slab {
  double x_m = 0, y_m = 0, yaw_rad = 0, length_m = 1, width_m = 1;
};

struct Layout {
  std::vector<Obstacle> obstacles = {};
  std::vector<Slab> table = {};  // the robot stands on it; empty: on a floor without end
  Eigen::Vector2d goal{0, 0};
  std::optional<double> goal_heading_rad = {};
  double density = 0;  // 0..1
};

// What layouts are drawn from.
struct LayoutRange {
  double bearing_deg = 90;  // of the goal, at most so far to either side
  Interval goal_distance_m{0.7, 1.5};
  Interval density{0, 1};
  int max_obstacles = 8;  // of kinds with clutter: half of it to all
};

// One that may be of no use. `ball_is_goal`: the goal has no heading, and is at `ball` in clutter and
// two-balls; in the other kinds, which need room for what they are, it is drawn anyway.
Layout draw_layout(WorldKind kind, const LayoutRange& range, std::uint64_t seed, bool ball_is_goal,
                   const Eigen::Vector2d& ball);

// A box, can or large ball `near` to `far` m from the start, in any direction. `rgb`: its colour, that of the
// ball to catch; null: one that no ball has. No ball that it draws is of the size of one to catch.
class Dice;
Obstacle draw_prop(Dice& dice, double near_m, double far_m, const std::array<double, 3>* rgb);

// The floor as it truly is, after everything has slid to its place, in a square of 2 `reach_m` around the
// start: what stands there, and what is beside the table, is obstacle.
plan::Grid true_grid(const Layout& layout, double reach_m);
// Of the grid to plan in: around start and goal, with room to walk around what is between.
double reach_of(const Layout& layout);
// Start and goal are free, before and after the slides, and a robot of 20 cm around its middle can walk from
// one to the other: more than it plans for itself, so that what it may think impassable is not drawn. The
// least time of walking there with the room that it needs, s; nothing where there is no way.
Result<std::optional<double>> least_seconds(const Layout& layout);

}  // namespace kaz::tools
