// Finds the connected regions of a mask, with area, bounding box and centroid.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kaz::vision {

// A mask has 8 bits per pixel: 255 if the pixel is selected, else 0. Rows from top to bottom, no padding.
struct Mask {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

// A run of pixels in one row, from `left` to `right` (both inclusive).
struct Run {
  int row, left, right;
};

// A region is 8-connected: pixels that touch at a corner belong to the same region.
struct Region {
  int area = 0;                                  // pixels
  int left = 0, top = 0, right = 0, bottom = 0;  // bounding box, inclusive
  double centroid_x = 0, centroid_y = 0;         // pixel centers at integer coordinates
  std::vector<Run> runs;                         // from top to bottom, left to right
};

// Splits each row into runs of selected pixels, and joins touching runs into regions by union-find. The
// computing time is about the time to read the mask once.
class RegionFinder {
 public:
  // Returns all regions of at least `min_area` pixels, largest first. Regions of equal area are in scan order
  // from the top. The result is valid until the next call.
  std::span<const Region> find(const Mask& mask, int min_area = 1);

 private:
  void collect_runs(const Mask& mask);
  void join_rows();
  int root(int run);

  std::vector<Run> runs_;
  std::vector<int> parent_;     // for each run: index of the parent run (union-find)
  std::vector<int> row_start_;  // index of the first run of each row; last entry: number of runs
  // For the root run of each region: at first the area of the region, later the number of the region.
  std::vector<int> area_;
  std::vector<Region> regions_;
};

}  // namespace kaz::vision
