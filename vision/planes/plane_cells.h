// Reduces a depth image to square cells, each with a mean position and a mean disparity.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "vision/depth/depth.h"
#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

struct Cell {
  float u = 0, v = 0;  // mean position of pixels with depth, px from the principal point
  float d = 0;         // mean disparity of these pixels, px
  // True if at least a quarter of the cell's pixels have depth and these pixels belong to one surface.
  bool usable = false;
};

struct CellGrid {
  int size = 1;  // side of a cell, px
  int columns = 0, rows = 0;
  float cx = 0, cy = 0;
  std::vector<Cell> cells;

  void fill(const DepthImage& depth);

 private:
  // For each pixel column: sum, minimum and maximum of the disparities in one row of cells.
  std::vector<float> sum_, min_, max_;
  std::vector<int> count_;
  std::vector<std::array<float, 3>> known_;
  Cell partly(const DepthImage& depth, int column, int row, float spread);
};

}  // namespace kaz::vision
