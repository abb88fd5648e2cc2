// Paths in the least time for a robot that walks straight ahead and turns on the spot.
// SPDX-License-Identifier: Apache-2.0
//
// A turn of 45 degrees takes as long as a third of a metre straight ahead, so the shortest path is seldom the
// fastest, and the least-time paths of such a robot are turns and straight lines by turns (Furtuna and
// Balkcom, "Generalizing Dubins curves: minimum-time sequences of body-fixed rotations and translations in
// the plane", IJRR 2010). The robot's outline is a disc around the middle between its feet: what is clear
// of it can be turned in.
//
// Frame: that of the grid; x forward, y left, headings from x towards y. Units m, rad, s.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "host/map/local_map.h"
#include "shared/base/angle.hpp"
#include "shared/base/result.hpp"

namespace kaz::plan {

// What a map says of the floor; cells by row of equal x. Outside of it all is unknown, and no path leads
// there.
struct Grid {
  int cells_x = 0, cells_y = 0;
  double cell_m = 0.01;
  Eigen::Vector2d corner{0, 0};       // of the cell 0, 0: its least x and y
  std::vector<map::CellState> state;  // [x * cells_y + y]

  map::CellState at(int x, int y) const {
    return inside(x, y) ? state[index(x, y)] : map::CellState::unknown;
  }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < cells_x && y < cells_y; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(cells_y) +
           static_cast<std::size_t>(y);
  }
  Eigen::Vector2i cell(const Eigen::Vector2d& p) const {
    // Far places stay outside, within the range of int.
    return ((p - corner) / cell_m).array().floor().max(-1e9).min(1e9).cast<int>();
  }
  Eigen::Vector2d middle(int x, int y) const {
    return corner + cell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
  }
};
// The square of `size_m` around the map's origin. What a single picture took for an obstacle is unknown.
Grid grid_of(const map::LocalMap& map, double size_m);

// Obstacles of fewer than `cells` cells, corners touching, become unknown if all of them are farther than
// `beyond_m` from `from`.
void forget_specks(Grid& grid, int cells, const Eigen::Vector2d& from, double beyond_m);

struct Pose {
  Eigen::Vector2d position{0, 0};
  double heading_rad = 0;
};
struct Goal {
  Eigen::Vector2d position{0, 0};
  std::optional<double> heading_rad;  // none: any
};

struct PlanOptions {
  double turn_s_per_rad = 6.6 / (45 * kDegree);  // docs/results/walking.md
  double go_s_per_m = 6.6 / 0.33;
  double radius_m = 0.16;  // of the disc: the hands in the crouch, and 2 cm of sway
  // On the time in unknown cells, 1 or more. Infinite: they are obstacles, those outside of the grid are not.
  double unknown_factor = 2;
  // Else turns are multiples of 45 degrees from the start's heading, but for the last to the goal's heading.
  bool any_heading = true;
};

struct Leg {
  enum class Kind { turn, go };
  Kind kind = Kind::go;
  double amount = 0;  // rad, to the left positive; m
};

struct Path {
  std::vector<Leg> legs;                 // none of zero length
  std::vector<Eigen::Vector2d> corners;  // start, where it turns, goal
  double seconds = 0;                    // of walking; in unknown cells without the factor
  // Of the way on the planner's graph, before straight lines replace parts of it, with the factor. The grid
  // planner's is from cell to cell: `seconds` is more by at most what start and goal lie beside the middles
  // of their cells.
  double searched_seconds = 0;
  std::size_t expanded = 0;  // states of the search
};

// Why there is none.
struct NoPath {
  // not_found: there is one, but a planner that draws samples did not find it.
  enum class Why { start_outside, goal_outside, start_blocked, goal_blocked, enclosed, not_found };
  Why why = Why::enclosed;
  // The obstacle in the way; of the widest way to the goal, that at its narrowest place.
  Eigen::Vector2d where{0, 0};
  double clear_m = 0;  // what is free there to each side
};
// "the goal is 0.04 m from an obstacle at (0.525, 0.105); the robot needs 0.16 m".
std::string text(const NoPath& none, const PlanOptions& options);

// The middle of the floor cell nearest to `to` that the robot may stand in and reach from `from`, at least
// from cell to cell. Nothing: it cannot stand at `from`.
std::optional<Eigen::Vector2d> nearest_reachable(const Grid& grid, const Eigen::Vector2d& from,
                                                 const Eigen::Vector2d& to,
                                                 const PlanOptions& options);

using Planned = std::variant<Path, NoPath>;

class Planner {
 public:
  virtual ~Planner() = default;
  virtual std::string name() const = 0;
  // Errors (usage): an empty grid, options out of their range, numbers that are not finite.
  virtual Result<Planned> plan(const Grid& grid, const Pose& start, const Goal& goal,
                               const PlanOptions& options) = 0;
};

}  // namespace kaz::plan
