// From planes and the cells on them to pixels, and what is known of each segment.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vision/planes/plane_cells.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision {

constexpr int kMostPlanes = 16;

class PlanePixels {
 public:
  void begin(const CellGrid& grid);
  // A plane and its connected parts, as numbers of cells.
  void add(const DisparityPlane& plane, const std::vector<std::vector<int>>& parts);
  int planes() const { return static_cast<int>(planes_.size()); }

  // Every pixel within the tolerance of planes whose cells it is in or beside goes to the nearest
  // of them.
  void assign(const DepthImage& depth, float tolerance, PlaneSegments& found);

 private:
  struct Sums {  // over a segment's pixels; of squares: disparity minus the plane's, and its share
    int pixels = 0, left = 1 << 30, top = 1 << 30, right = -1, bottom = -1;
    double r2 = 0, relative2 = 0;
  };
  // Over the pixels of one plane in one cell.
  struct CellSums {
    int n = 0;
    float r2 = 0;
  };
  void assign_cell(const DepthImage& depth, int column, int row, float tolerance,
                   PlaneSegments& found);
  void assign_run(const DepthImage& depth, int column, int end, int row, float tolerance,
                  PlaneSegments& found);
  void take(int segment, int column, int row, int n, double r2);
  int segment_of(int plane, int column, int row) const {
    return segment_at_[static_cast<std::size_t>(plane)]
                      [static_cast<std::size_t>(row * grid_->columns + column)] -
           1;
  }
  void describe(const CameraModel& camera, int segment, PlaneSegment& out) const;

  const CellGrid* grid_ = nullptr;
  std::vector<DisparityPlane> planes_;
  std::vector<int> plane_of_;                          // of each segment
  std::vector<std::vector<int>> cells_;                // of each segment
  std::vector<std::uint16_t> mask_;                    // per cell: planes that are near
  std::vector<std::vector<std::uint8_t>> segment_at_;  // per plane and cell: segment + 1, 0 none
  std::vector<Sums> sums_;
  std::vector<float> square_;  // of the columns of a run of cells
  std::vector<int> count_;
};

}  // namespace kaz::vision
