// Masks and their connected regions, with area, bounding box and centroid.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kaz::vision {

// 8 bits a pixel, 255 where the pixel is selected, else 0; rows from top to bottom, no padding.
struct Mask {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

// Pixels left..right (both inclusive) of one row.
struct Run {
  int row, left, right;
};

// 8-connected: pixels that touch at a corner belong together.
struct Region {
  int area = 0;                                  // pixels
  int left = 0, top = 0, right = 0, bottom = 0;  // bounding box, inclusive
  double centroid_x = 0, centroid_y = 0;         // pixel centres at integer coordinates
  std::vector<Run> runs;                         // from top to bottom, left to right
};

// Connected-component labelling by runs of pixels and union-find: the cost is that of reading the mask
// once.
class RegionFinder {
 public:
  // All regions of at least `min_area` pixels, largest first; among equal areas in the order
  // of a scan from the top. Valid until the next call.
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
