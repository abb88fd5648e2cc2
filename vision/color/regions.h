// Connected regions of a mask, with size, box and centroid.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vision/color/color.h"

namespace kaz::vision {

// Pixels left..right (both inside) of one row.
struct Run {
  int row, left, right;
};

// 8-connected: pixels that touch at a corner belong together.
struct Region {
  int area = 0;                                  // pixels
  int left = 0, top = 0, right = 0, bottom = 0;  // box, all four inside
  double centroid_x = 0, centroid_y = 0;         // pixel centres at integer coordinates
  std::vector<Run> runs;                         // from top to bottom, left to right
};

// Works on runs of pixels, not on pixels: the cost is that of reading the mask once.
class RegionFinder {
 public:
  // All regions of at least `min_area` pixels, largest first; of equal area, the one first met from
  // the top first. Valid until the next call.
  std::span<const Region> find(const Mask& mask, int min_area = 1);

 private:
  void collect_runs(const Mask& mask);
  void join_rows();
  int root(int run);

  std::vector<Run> runs_;
  std::vector<int> parent_;     // union-find over runs
  std::vector<int> row_start_;  // first run of each row, and the end
  std::vector<int> area_;       // by root run; then the number of its region
  std::vector<Region> regions_;
};

}  // namespace kaz::vision
