// Draws kinds of worlds, and finds whether there is a way in them.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "host/plan/grid_planner.h"
#include "shared/base/angle.hpp"
#include "tools/eval/dice.h"

namespace kaz::tools {
namespace {

using Eigen::Vector2d;

constexpr double kPi = std::numbers::pi;
constexpr double kStartFree = 0.28, kGoalFree = 0.24;  // m, around them
constexpr double kWall = 0.04;                         // m, thick

constexpr WorldKindInfo kKinds[] = {
    {WorldKind::clutter, "clutter", "boxes and cans at random places; density sets their number",
     0},
    {WorldKind::corridor, "corridor",
     "two walls, and a third behind the goal; a higher density makes the corridor narrower", 1.0},
    {WorldKind::slalom, "slalom",
     "walls that block the path alternately from left and right; a higher density puts these walls "
     "closer together",
     1.1},
    {WorldKind::u_trap, "u-trap",
     "a U-shaped wall in front of the goal, open toward the robot; a higher density makes the U "
     "deeper",
     1.1},
    {WorldKind::low_step, "low-step",
     "a plate, 2 cm high, across the path; a higher density makes the plate wider and adds more "
     "plates",
     0.8},
    {WorldKind::thin_poles, "thin-poles", "upright rods, 5 mm thick; density sets their number",
     0.7},
    {WorldKind::table_edge, "table-edge",
     "an L-shaped table top; a higher density makes the table top narrower", 0.9},
    {WorldKind::patterned_floor, "patterned-floor",
     "clutter on a checkered floor of random color; density sets the number of obstacles", 0},
    {WorldKind::plain_floor, "plain-floor",
     "clutter on a floor of one color, without a pattern; density sets the number of obstacles", 0},
    {WorldKind::moving_box, "moving-box",
     "a box that slides into the way while the robot walks; density sets the number of other "
     "obstacles",
     1.1},
    {WorldKind::dark, "dark", "clutter in dim light; density sets the number of obstacles", 0},
    {WorldKind::two_balls, "two-balls",
     "the ball to catch, a ball of another color, and clutter; density sets the number of "
     "obstacles",
     0},
};

// No obstacle has the color of a ball, red or green.
constexpr std::array<std::array<double, 3>, 6> kThings{{{0.16, 0.33, 0.70},
                                                        {0.90, 0.76, 0.16},
                                                        {0.42, 0.30, 0.62},
                                                        {0.88, 0.87, 0.84},
                                                        {0.30, 0.28, 0.27},
                                                        {0.55, 0.42, 0.30}}};

// A layout as it is drawn. Structures are drawn along the line from start to goal: u along it, v to its
// left.
struct Draft {
  Dice dice;
  double line_rad, distance;
  int max_obstacles;
  Layout layout;

  Vector2d at(double u, double v) const { return Eigen::Rotation2Dd(line_rad) * Vector2d(u, v); }
  std::array<double, 3> paint() { return kThings[dice.below(kThings.size())]; }

  // A box whose middle is at u, v; `turned` against the line.
  Obstacle& box(double u, double v, double along, double across, double height, double turned = 0) {
    const Vector2d middle = at(u, v);
    layout.obstacles.push_back({.x_m = middle.x(),
                                .y_m = middle.y(),
                                .yaw_rad = line_rad + turned,
                                .length_m = along,
                                .width_m = across,
                                .height_m = height,
                                .rgb = paint()});
    return layout.obstacles.back();
  }
  bool leaves_ends_free(const Obstacle& o) const {
    return distance_to(o, {0, 0}) > kStartFree && distance_to(o, layout.goal) > kGoalFree;
  }
};

Obstacle draw_obstacle(Dice& dice, double reach_m) {
  Obstacle o;
  o.shape = dice(0, 1) < 0.3 ? Shape::can : Shape::box;
  o.length_m = dice(0.06, 0.22);
  o.width_m = o.shape == Shape::can ? o.length_m : dice(0.06, 0.22);
  o.height_m = dice(0.05, 0.24);
  o.yaw_rad = dice(-kPi, kPi);
  o.x_m = dice(-0.5, reach_m);
  o.y_m = dice(-reach_m, reach_m);
  o.rgb = kThings[dice.below(kThings.size())];
  return o;
}

// Beside the balls that are there already.
void clutter(Draft& d) {
  const int most = d.max_obstacles, half = (most + 1) / 2;
  const auto count = static_cast<std::size_t>(half + (most + 0.999 - half) * d.layout.density);
  const std::vector<Obstacle> balls = d.layout.obstacles;
  while (d.layout.obstacles.size() < balls.size() + count) {
    const Obstacle o = draw_obstacle(d.dice, d.layout.goal.norm() + 0.4);
    const bool on_ball = std::ranges::any_of(
        balls, [&](const Obstacle& ball) { return distance_to(o, ball.place()) < 0.1; });
    if (d.leaves_ends_free(o) && !on_ball) d.layout.obstacles.push_back(o);
  }
}

// The goal is at its end, which is closed, so the way is between the walls.
void corridor(Draft& d) {
  const double width = 0.80 - 0.30 * d.layout.density, height = d.dice(0.10, 0.24);
  const double from = d.dice(0.30, 0.45), to = d.distance + 0.30;
  for (const int side : {-1, 1})
    d.box((from + to) / 2, side * (width + kWall) / 2, to - from, kWall, height);
  d.box(to + kWall / 2, 0, kWall, width + 2 * kWall, height);
}

void slalom(Draft& d) {
  const double spacing = 0.60 - 0.12 * d.layout.density, beyond = -0.08 + 0.18 * d.layout.density;
  const double height = d.dice(0.10, 0.24), outer = 0.55;
  double side = d.dice.side();
  for (double u = d.dice(0.36, 0.42); u < d.distance - 0.28; u += spacing) {
    d.box(u, side * (outer - beyond) / 2, kWall, outer + beyond, height);
    side = -side;
  }
}

void u_trap(Draft& d) {
  const double depth = std::min(0.12 + 0.33 * d.layout.density, d.distance - 0.70);
  const double width = d.dice(0.50, 0.80), height = d.dice(0.10, 0.24);
  const double bottom = d.dice(0.36 + depth, d.distance - 0.28 - kWall);
  d.box(bottom + kWall / 2, 0, kWall, width + 2 * kWall, height);
  for (const int side : {-1, 1})
    d.box(bottom - depth / 2, side * (width + kWall) / 2, depth, kWall, height);
}

void low_step(Draft& d) {
  constexpr double kStep = 0.02;  // m; a foot is lifted by less
  const double across = 0.25 + 0.45 * d.layout.density;
  d.box(d.dice(0.40, d.distance - 0.35), d.dice(-0.1, 0.1), d.dice(0.06, 0.18), across, kStep,
        d.dice(-0.4, 0.4));
  const auto more = static_cast<std::size_t>(3.99 * d.layout.density);
  for (std::size_t i = 0; i < more;) {
    Obstacle o = draw_obstacle(d.dice, d.distance + 0.4);
    o.shape = Shape::box;
    o.height_m = kStep;
    if (!d.leaves_ends_free(o)) continue;
    d.layout.obstacles.push_back(o);
    ++i;
  }
}

void thin_poles(Draft& d) {
  const auto pole = [&](double u, double v) {
    const Vector2d middle = d.at(u, v);
    Obstacle o{.x_m = middle.x(), .y_m = middle.y(), .shape = Shape::can};
    o.length_m = o.width_m = 0.005;
    o.height_m = d.dice(0.20, 0.45);
    o.rgb = d.paint();
    d.layout.obstacles.push_back(o);
  };
  pole(d.dice(0.36, d.distance - 0.30), d.dice(-0.05, 0.05));
  const auto more = 1 + static_cast<std::size_t>(7.99 * d.layout.density);
  for (std::size_t i = 0; i < more; ++i) pole(d.dice(0.0, d.distance), d.dice(-0.6, 0.6));
}

// Two legs: the line between start and goal leads over the void at the inner corner.
void table_edge(Draft& d) {
  const double width = 0.84 - 0.24 * d.layout.density, side = d.dice.side();
  const double turned = d.dice(35 * kDegree, 55 * kDegree);
  const Vector2d corner(d.distance * std::cos(turned), d.distance * std::sin(turned));
  const double yaw = d.line_rad - side * turned;
  const auto slab = [&](double x0, double x1, double y0, double y1) {
    const Vector2d middle = Eigen::Rotation2Dd(yaw) * Vector2d((x0 + x1) / 2, side * (y0 + y1) / 2);
    d.layout.table.push_back({middle.x(), middle.y(), yaw, x1 - x0, y1 - y0});
  };
  slab(-0.40, corner.x() + width / 2, -width / 2, width / 2);
  slab(corner.x() - width / 2, corner.x() + width / 2, width / 2, corner.y() + 0.35);
}

// When a robot that walks straight to the goal has come so far, s from the start of the world: it stands up,
// looks around and turns, then walks pieces of 30 cm and looks between them. The times are those of `kaz run
// navigate --goal 1.2,0 --world empty --eyes real --imu --mcu native`.
double walked_at_s(double bearing_rad, double distance_m) {
  constexpr double kBegins = 13, kPiece = 0.3, kLook = 2.4, kSteered = 9 * kDegree;
  const plan::PlanOptions speeds;
  const double turn =
      std::abs(bearing_rad) > kSteered ? std::abs(bearing_rad) * speeds.turn_s_per_rad + kLook : 0;
  return kBegins + turn + distance_m * speeds.go_s_per_m + kLook * std::floor(distance_m / kPiece);
}

// The line to the goal is free until a box slides onto it from the side, 45 to 75 cm before the robot.
void moving_box(Draft& d) {
  const double stops = d.dice(0.50, d.distance - 0.36);
  const double robot = std::max(0.0, stops - d.dice(0.45, 0.75));
  const double side = d.dice.side(), from = side * d.dice(0.45, 0.75), to = d.dice(-0.05, 0.05);
  const double length = d.dice(0.08, 0.18), width = d.dice(0.08, 0.18);
  Obstacle& mover =
      d.box(stops, from, length, width, std::min(length, width) * d.dice(0.7, 1), d.dice(-1, 1));
  mover.slide = {walked_at_s(d.line_rad, robot), d.at(0, to - from)};
  const Obstacle moved = mover;
  const auto more = static_cast<std::size_t>(4.99 * d.layout.density);
  const double reach = d.distance + 0.4;
  while (d.layout.obstacles.size() < 1 + more) {
    const Obstacle o = draw_obstacle(d.dice, reach);
    bool clear = d.leaves_ends_free(o);
    for (double u = 0; u < d.distance; u += 0.02) clear = clear && distance_to(o, d.at(u, 0)) > 0.3;
    for (double v = 0; v < 1; v += 0.02)
      clear = clear && distance_to(o, moved.place() + v * moved.slide->by_m) > 0.2;
    if (clear) d.layout.obstacles.push_back(o);
  }
}

void two_balls(Draft& d, std::size_t others) {
  while (d.layout.obstacles.size() < others) {
    const Vector2d middle = d.at(d.dice(0.2, d.distance + 0.2), d.dice(-0.5, 0.5));
    Obstacle o{.x_m = middle.x(), .y_m = middle.y(), .shape = Shape::ball};
    o.length_m = o.width_m = o.height_m = 0.04;
    if (d.leaves_ends_free(o)) d.layout.obstacles.push_back(o);
  }
  d.max_obstacles /= 2;
  clutter(d);
}

bool on_table(const std::vector<Slab>& table, const Vector2d& place) {
  return table.empty() || std::ranges::any_of(table, [&](const Slab& slab) {
           const Vector2d at =
               Eigen::Rotation2Dd(-slab.yaw_rad) * (place - Vector2d(slab.x_m, slab.y_m));
           return std::abs(at.x()) <= slab.length_m / 2 && std::abs(at.y()) <= slab.width_m / 2;
         });
}

bool ends_are_free(const Layout& layout) {
  return std::ranges::all_of(layout.obstacles, [&](const Obstacle& o) {
    return std::min(distance_to(o, {0, 0}), distance_to(at_rest(o), {0, 0})) > kStartFree &&
           std::min(distance_to(o, layout.goal), distance_to(at_rest(o), layout.goal)) > kGoalFree;
  });
}

}  // namespace

std::span<const WorldKindInfo> world_kinds() {
  return kKinds;
}

const char* to_string(WorldKind kind) {
  return kKinds[static_cast<std::size_t>(kind)].name;
}

bool has_clutter(WorldKind kind) {
  switch (kind) {
    case WorldKind::clutter:
    case WorldKind::patterned_floor:
    case WorldKind::plain_floor:
    case WorldKind::dark:
    case WorldKind::two_balls:
      return true;
    default:
      return false;
  }
}

Result<std::vector<WorldKind>> parse_world_kinds(const std::vector<std::string>& names) {
  std::vector<WorldKind> kinds;
  std::string all;
  for (const WorldKindInfo& info : kKinds) all += std::string(", ") + info.name;
  for (const std::string& name : names) {
    const std::size_t before = kinds.size();
    for (const WorldKindInfo& info : kKinds)
      if (name == "all" || name == info.name) kinds.push_back(info.kind);
    if (kinds.size() == before)
      return fail(Fault::usage,
                  "'" + name + "' is not a kind of world: use one of these: all" + all);
  }
  return kinds;
}

const char* density_grade(double density) {
  return density < 1.0 / 3 ? "sparse" : density < 2.0 / 3 ? "medium" : "dense";
}

Layout draw_layout(WorldKind kind, const LayoutRange& range, std::uint64_t seed, bool ball_is_goal,
                   const Vector2d& ball) {
  Dice aim(seed, Draw::goal);
  const double min_goal = kKinds[static_cast<std::size_t>(kind)].min_goal_m;
  const Interval distances{std::max(range.goal_distance_m.min, min_goal),
                           std::max(range.goal_distance_m.max, min_goal)};
  const double bearing = range.bearing_deg * kDegree * aim(-1, 1);
  const double distance = aim(distances.min, distances.max);
  const bool has_heading = aim(0, 1) < 0.5 && !ball_is_goal;
  const double heading = aim(-kPi, kPi);
  Draft d{Dice(seed, Draw::obstacles), bearing, distance, range.max_obstacles, {}};
  if (ball_is_goal && (kind == WorldKind::clutter || kind == WorldKind::two_balls)) {
    d.line_rad = std::atan2(ball.y(), ball.x());
    d.distance = ball.norm();
    d.layout.goal = ball;
  } else {
    d.layout.goal = d.at(distance, 0);
  }
  if (has_heading) d.layout.goal_heading_rad = heading;
  d.layout.density = d.dice(range.density.min, range.density.max);
  switch (kind) {
    case WorldKind::clutter:
    case WorldKind::patterned_floor:
    case WorldKind::plain_floor:
    case WorldKind::dark:
      clutter(d);
      break;
    case WorldKind::corridor:
      corridor(d);
      break;
    case WorldKind::slalom:
      slalom(d);
      break;
    case WorldKind::u_trap:
      u_trap(d);
      break;
    case WorldKind::low_step:
      low_step(d);
      break;
    case WorldKind::thin_poles:
      thin_poles(d);
      break;
    case WorldKind::table_edge:
      table_edge(d);
      break;
    case WorldKind::moving_box:
      moving_box(d);
      break;
    case WorldKind::two_balls:
      two_balls(d, ball_is_goal ? 1 : 2);
      break;
  }
  return std::move(d.layout);
}

Obstacle draw_prop(Dice& dice, double near_m, double far_m, const std::array<double, 3>* rgb) {
  Obstacle o;
  const double kind = dice(0, 1);
  o.shape = kind < 0.25 ? Shape::can : kind < 0.5 ? Shape::ball : Shape::box;
  // Balls of 7 cm and more: those to catch have 4.
  o.length_m = o.shape == Shape::ball ? dice(0.07, 0.12) : dice(0.03, 0.20);
  o.width_m = o.shape == Shape::box ? dice(0.03, 0.20) : o.length_m;
  o.height_m = o.shape == Shape::ball ? o.length_m : dice(0.03, 0.24);
  const double bearing = dice(-kPi, kPi), distance = dice(near_m, far_m);
  o.x_m = distance * std::cos(bearing);
  o.y_m = distance * std::sin(bearing);
  o.yaw_rad = dice(-kPi, kPi);
  o.rgb = rgb != nullptr ? *rgb : kThings[dice.below(kThings.size())];
  return o;
}

plan::Grid true_grid(const Layout& layout, double reach_m) {
  plan::Grid grid;
  grid.cells_x = grid.cells_y = static_cast<int>(std::ceil(2 * reach_m / grid.cell_m));
  grid.corner = {-reach_m, -reach_m};
  grid.state.assign(static_cast<std::size_t>(grid.cells_x) * static_cast<std::size_t>(grid.cells_y),
                    map::CellState::floor);
  std::vector<Obstacle> obstacles;
  for (const Obstacle& o : layout.obstacles) obstacles.push_back(at_rest(o));
  for (int x = 0; x < grid.cells_x; ++x) {
    for (int y = 0; y < grid.cells_y; ++y) {
      const Vector2d at = grid.middle(x, y);
      if (!on_table(layout.table, at) || std::ranges::any_of(obstacles, [&](const Obstacle& o) {
            return distance_to(o, at) == 0;
          }))
        grid.state[grid.index(x, y)] = map::CellState::obstacle;
    }
  }
  // A pole may stand between the middles of cells.
  for (const Obstacle& o : obstacles) {
    const Eigen::Vector2i cell = grid.cell(o.place());
    if (grid.inside(cell.x(), cell.y()))
      grid.state[grid.index(cell.x(), cell.y())] = map::CellState::obstacle;
  }
  return grid;
}

double reach_of(const Layout& layout) {
  return layout.goal.norm() + 0.4 + 0.4;
}

Result<std::optional<double>> least_seconds(const Layout& layout) {
  if (!ends_are_free(layout)) return std::nullopt;
  plan::PlanOptions options;
  options.radius_m = 0.20;
  const auto planner = plan::make_grid_planner();
  const plan::Grid grid = true_grid(layout, reach_of(layout));
  const plan::Goal goal{layout.goal, layout.goal_heading_rad};
  const auto way = KAZ_TRY(planner->plan(grid, {}, goal, options));
  if (!std::holds_alternative<plan::Path>(way)) return std::nullopt;
  options.radius_m = plan::PlanOptions{}.radius_m;
  const auto least = KAZ_TRY(planner->plan(grid, {}, goal, options));
  return std::get<plan::Path>(least).seconds;
}

}  // namespace kaz::tools
