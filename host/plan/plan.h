// Fastest paths for a robot that walks straight ahead and turns on the spot.
// SPDX-License-Identifier: Apache-2.0
//
// A turn of 45 degrees takes as long as a walk of a third of a meter. So the shortest path is seldom the
// fastest. The least-time paths of such a robot alternate turns and straight lines. Source: Furtuna and
// Balkcom, "Generalizing Dubins curves: minimum-time sequences of body-fixed rotations and translations in
// the plane", IJRR 2010. The robot's outline is modeled as a disc around the midpoint between the feet. So
// the robot can turn wherever the disc is free.
//
// Frame: the frame of the grid; x forward, y left, headings positive from x toward y. Units: m, rad, s.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "host/map/local_map.h"
#include "shared/base/angle.hpp"
#include "shared/base/result.hpp"

namespace kaz::plan {

// State of each cell of the floor. Everything outside of the grid is unknown, and no path leads out of the
// grid.
struct Grid {
  int cells_x = 0, cells_y = 0;
  double cell_m = 0.01;
  Eigen::Vector2d corner{0, 0};       // corner of cell (0, 0) with the smallest x and y
  std::vector<map::CellState> state;  // state of cell (x, y) at index x * cells_y + y

  map::CellState at(int x, int y) const {
    return inside(x, y) ? state[index(x, y)] : map::CellState::unknown;
  }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < cells_x && y < cells_y; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(cells_y) +
           static_cast<std::size_t>(y);
  }
  Eigen::Vector2i cell(const Eigen::Vector2d& p) const {
    // Places far outside of the grid are clamped, so that the numbers fit into an int.
    return ((p - corner) / cell_m).array().floor().max(-1e9).min(1e9).cast<int>();
  }
  Eigen::Vector2d middle(int x, int y) const {
    return corner + cell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
  }
};
// Returns a square part of the map with the side `size_m`, centered on the map's origin. An obstacle cell
// with only a single vote becomes unknown (LocalMap::certain).
Grid grid_of(const map::LocalMap& map, double size_m);

// Changes the cells of small, distant obstacles to unknown. A small, distant obstacle has fewer than `cells`
// cells, and all its cells are farther than `beyond_m` from `from`. Obstacle cells that touch, even only at a
// corner, form one obstacle.
void forget_specks(Grid& grid, int cells, const Eigen::Vector2d& from, double beyond_m);

struct Pose {
  Eigen::Vector2d position{0, 0};
  double heading_rad = 0;
};
struct Goal {
  Eigen::Vector2d position{0, 0};
  std::optional<double> heading_rad;  // empty: any heading
};

// The default times come from measured walks and turns (docs/results/README.md).
struct PlanOptions {
  double turn_s_per_rad = 6.6 / (45 * kDegree);
  double go_s_per_m = 6.6 / 0.33;
  // Radius of the robot's disc. The disc covers the crouching robot, hands included. The radius contains a
  // margin of 2 cm for the sway of the robot.
  double radius_m = 0.16;
  // The time spent in unknown cells is multiplied by this factor, 1 or more. If the factor is infinite,
  // unknown cells are obstacles.
  double unknown_factor = 2;
  // If false, all turns except the last one are multiples of 45 degrees. The last turn ends at the goal's
  // heading, and the path ends in the center of a cell.
  bool any_heading = true;
};

struct Leg {
  enum class Kind { turn, go };
  Kind kind = Kind::go;
  double amount = 0;  // turn: rad, positive to the left; go: m
};

struct Path {
  std::vector<Leg> legs;                 // legs of zero length are omitted
  std::vector<Eigen::Vector2d> corners;  // start, turning points, goal
  // Duration of the path, s. The time in unknown cells is not multiplied by PlanOptions::unknown_factor.
  double seconds = 0;
  // Duration of the path on the planner's graph, before straight lines replace parts of the path, s.
  // The time in unknown cells is multiplied by PlanOptions::unknown_factor. The grid planner's path leads
  // from cell center to cell center. So `seconds` can exceed `searched_seconds` by up to the time to walk the
  // diagonal of one cell.
  double searched_seconds = 0;
  std::size_t expanded = 0;  // number of states that the search expanded
};

// Reason why there is no path.
struct NoPath {
  // not_found: there is a path, but a sampling planner did not find it.
  enum class Why { start_outside, goal_outside, start_blocked, goal_blocked, enclosed, not_found };
  Why why = Why::enclosed;
  // Position of the obstacle in the way. For `enclosed` and `not_found`: the obstacle that is nearest to the
  // widest way. The widest way is the way to the goal that keeps the largest distance from obstacles. For
  // start_outside and goal_outside: the position of the start or the goal.
  Eigen::Vector2d where{0, 0};
  // Distance from the obstacle at `where` to the start (start_blocked), to the goal (goal_blocked), or to the
  // widest way (enclosed, not_found).
  double clear_m = 0;
};
// Returns the reason as text, such as "the goal is 0.04 m from an obstacle at (0.525, 0.105); the robot needs
// a distance of at least 0.16 m".
std::string text(const NoPath& none, const PlanOptions& options);

// The robot starts at the point `from` and moves in steps between neighboring cells. The function searches
// all floor cells that the robot can reach in this way. Returns the center of the reachable floor cell that
// is nearest to `to`. Returns nothing if the robot cannot stand at `from`, or if no floor is reachable.
std::optional<Eigen::Vector2d> nearest_reachable(const Grid& grid, const Eigen::Vector2d& from,
                                                 const Eigen::Vector2d& to,
                                                 const PlanOptions& options);

using Planned = std::variant<Path, NoPath>;

class Planner {
 public:
  virtual ~Planner() = default;
  virtual std::string name() const = 0;
  // Returns the fastest path found, or the reason why no path exists. Errors (usage): an empty grid,
  // options out of range, or numbers that are not finite.
  virtual Result<Planned> plan(const Grid& grid, const Pose& start, const Goal& goal,
                               const PlanOptions& options) = 0;
};

}  // namespace kaz::plan
