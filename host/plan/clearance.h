// Distance of each cell to the nearest obstacle. Internal to host/plan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "host/plan/plan.h"

namespace kaz::plan {

class Clearance {
 public:
  Clearance(const Grid& grid, const PlanOptions& options);

  // m, from the cell's middle to the nearest obstacle cell's edge, at least 0.
  double m(int x, int y) const { return clear_m_[grid_.index(x, y)]; }
  // Whether the robot may stand with its middle in this cell.
  bool free(int x, int y) const { return grid_.inside(x, y) && free_[grid_.index(x, y)] != 0; }
  // Factor on the time that is spent in this cell.
  double factor(int x, int y) const {
    return grid_.state[grid_.index(x, y)] == map::CellState::unknown ? unknown_factor_ : 1;
  }
  // Length of the line from `a` to `b`, weighted by factor(); infinite if it meets a cell that is not free.
  double weighted_m(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  // Whether free cells that touch, at a side or a corner, lead from one free cell to the other.
  bool connected(const Eigen::Vector2i& from, const Eigen::Vector2i& to) const;
  // Of the floor cells so connected with this free one, that nearest to `to`.
  std::optional<Eigen::Vector2i> nearest_connected(const Eigen::Vector2i& from,
                                                   const Eigen::Vector2d& to) const;
  // The narrowest place of the widest way between two cells.
  NoPath narrowest(const Eigen::Vector2i& from, const Eigen::Vector2i& to) const;
  const Grid& grid() const { return grid_; }

 private:
  // The obstacle cell nearest to this one.
  Eigen::Vector2d obstacle_near(const Eigen::Vector2i& cell) const;
  const Grid& grid_;
  double unknown_factor_;
  std::vector<float> clear_m_;
  std::vector<std::uint8_t> free_;
};

}  // namespace kaz::plan
