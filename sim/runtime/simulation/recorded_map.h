// A host's map of the floor, for the recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace kaz::sim {

// Frame "map": x ahead, y left, on the floor. m, rad.
struct RecordedMap {
  double cell_m = 0;
  int cells_x = 0, cells_y = 0;
  Eigen::Vector2d corner{0, 0};    // of the first cell
  std::vector<std::int8_t> cells;  // x fastest; 0..100: % of an obstacle's probability, -1: unknown
  std::vector<Eigen::Vector2d> path;  // corners, from start to goal; empty: none
  Eigen::Vector2d robot{0, 0};
  double heading_rad = 0;
};

}  // namespace kaz::sim
