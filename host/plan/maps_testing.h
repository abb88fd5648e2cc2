// Random maps for tests and benchmarks of planners.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/plan/plan.h"
#include "shared/base/random.hpp"

namespace kaz::plan {

// Returns a floor of 2 m by 2 m, which begins at x = 0 and y = -1 m.
inline Grid floor_grid() {
  Grid grid;
  grid.cells_x = grid.cells_y = 200;
  grid.corner = {0, -1};
  grid.state.assign(200 * 200, map::CellState::floor);
  return grid;
}

// Sets all cells whose center is in the rectangle.
inline void fill(Grid& grid, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                 map::CellState state) {
  for (int x = 0; x < grid.cells_x; ++x) {
    for (int y = 0; y < grid.cells_y; ++y) {
      const Eigen::Vector2d p = grid.middle(x, y);
      if ((p.array() >= from.array()).all() && (p.array() <= to.array()).all())
        grid.state[grid.index(x, y)] = state;
    }
  }
}

// Returns floor_grid() with 2 to 15 boxes with sides of 1 to 50 cm, none within 15 cm of `a` and `b`.
inline Grid random_grid(Random& random, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  Grid grid = floor_grid();
  const auto draw = [&](double low, double high) { return low + (high - low) * random.uniform(); };
  const int boxes = static_cast<int>(draw(2, 16));
  for (int i = 0; i < boxes; ++i) {
    const double x = draw(0, 2), y = draw(-1, 1), half_x = draw(0.005, 0.25);
    const Eigen::Vector2d middle(x, y), half(half_x, draw(0.005, 0.25));
    const auto near = [&](const Eigen::Vector2d& p) {
      return ((p - middle).cwiseAbs() - half).maxCoeff() < 0.15;
    };
    if (!near(a) && !near(b)) fill(grid, middle - half, middle + half, map::CellState::obstacle);
  }
  return grid;
}

}  // namespace kaz::plan
