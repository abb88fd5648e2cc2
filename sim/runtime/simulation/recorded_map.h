// The host's map of the floor, for recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace kaz::sim {

// Positions on the floor, in m, in the frame "map": x points forward, y to the left.
struct RecordedMap {
  double cell_m = 0;
  int cells_x = 0, cells_y = 0;
  Eigen::Vector2d corner{0, 0};  // smallest x and smallest y of the first cell
  // Obstacle probability of each cell, 0..100 %; -1: unknown. Cells with adjacent x are adjacent in the
  // vector.
  std::vector<std::int8_t> cells;
  std::vector<Eigen::Vector2d> path;  // vertices of the path from start to goal; empty: no path
  Eigen::Vector2d robot{0, 0};
  double heading_rad = 0;
};

}  // namespace kaz::sim
