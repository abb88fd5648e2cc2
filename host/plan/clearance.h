// Distance of each cell to the nearest obstacle. Internal to host/plan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "host/plan/plan.h"

namespace kaz::plan {

// A Clearance belongs to one grid, which must outlive the Clearance. With an infinite
// PlanOptions::unknown_factor, unknown cells are obstacles.
class Clearance {
 public:
  Clearance(const Grid& grid, const PlanOptions& options);

  // Returns the clearance, m, which is a lower bound on the distance from the cell's center to the nearest
  // obstacle cell. The bound is the distance between both cell centers minus half a cell diagonal, but at
  // least 0.
  double m(int x, int y) const { return clear_m_[grid_.index(x, y)]; }
  // Returns whether the robot may stand with its center in this cell.
  bool free(int x, int y) const { return grid_.inside(x, y) && free_[grid_.index(x, y)] != 0; }
  // Returns the factor on the time spent in this cell.
  double factor(int x, int y) const {
    return grid_.state[grid_.index(x, y)] == map::CellState::unknown ? unknown_factor_ : 1;
  }
  // Returns the length of the line from `a` to `b`, weighted by factor(); infinite if the line crosses a cell
  // that is not free.
  double weighted_m(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  // Returns whether neighboring free cells (sides or corners) connect the two cells. Both cells must be free.
  bool connected(const Eigen::Vector2i& from, const Eigen::Vector2i& to) const;
  // Returns the floor cell nearest to `to` among the cells connected with `from`. Returns nothing if `from`
  // is not free, or if no floor cell is connected.
  std::optional<Eigen::Vector2i> nearest_connected(const Eigen::Vector2i& from,
                                                   const Eigen::Vector2d& to) const;
  // Finds the widest way between two cells, and returns its narrowest place with the reason
  // NoPath::Why::enclosed.
  NoPath narrowest(const Eigen::Vector2i& from, const Eigen::Vector2i& to) const;
  const Grid& grid() const { return grid_; }

 private:
  // Returns the center of the obstacle cell nearest to `cell`.
  Eigen::Vector2d obstacle_near(const Eigen::Vector2i& cell) const;
  const Grid& grid_;
  double unknown_factor_;
  std::vector<float> clear_m_;
  std::vector<std::uint8_t> free_;
};

}  // namespace kaz::plan
