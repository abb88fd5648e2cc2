// A depth image reduced to square cells: mean position and disparity of each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vision/depth/depth.h"
#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

struct Cell {
  float u = 0, v = 0;   // mean position of its pixels with depth, px from the principal point
  float d = 0;          // their mean disparity, px
  bool usable = false;  // at least a quarter of its pixels have depth, all of one surface
};

struct CellGrid {
  int size = 1;  // side of a cell, px
  int columns = 0, rows = 0;
  float cx = 0, cy = 0;
  std::vector<Cell> cells;

  void fill(const DepthImage& depth);

 private:
  std::vector<float> sum_, min_, max_;  // of the columns of a row of cells
  std::vector<int> count_;
  std::vector<std::array<float, 3>> known_;
  Cell partly(const DepthImage& depth, int column, int row, float spread);
};

}  // namespace kaz::vision
