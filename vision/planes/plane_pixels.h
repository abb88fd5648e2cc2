// Assigns pixels to plane segments and computes the geometry of each segment.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vision/planes/plane_cells.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision {

constexpr int kMaxPlanes = 16;

class PlanePixels {
 public:
  void begin(const CellGrid& grid);
  // Adds a plane and the connected parts of the plane. Each part is a list of cell numbers. All planes
  // together have at most 255 parts; further parts are ignored.
  void add(const DisparityPlane& plane, const std::vector<std::vector<int>>& parts);
  int planes() const { return static_cast<int>(planes_.size()); }

  // Labels each pixel with the plane that is nearest in disparity. A pixel can be labeled only with a
  // plane that has a part in the pixel's cell or in an adjacent cell. A pixel gets no label if its disparity
  // differs from the disparity of the nearest plane by `tolerance` (px) or more. Also computes the geometry
  // of the segments.
  void assign(const DepthImage& depth, float tolerance, PlaneSegments& found);

 private:
  // Sums over a segment's pixels: bounding box, squared residuals (px^2) and squared relative residuals.
  struct Sums {
    int pixels = 0, left = 1 << 30, top = 1 << 30, right = -1, bottom = -1;
    double r2 = 0, relative2 = 0;
  };
  // Sums over the pixels of one plane in one cell.
  struct CellSums {
    int n = 0;
    float r2 = 0;
  };
  void assign_cell(const DepthImage& depth, int column, int row, float tolerance,
                   PlaneSegments& found);
  void assign_run(const DepthImage& depth, int column, int end, int row, float tolerance,
                  PlaneSegments& found);
  void accumulate(int segment, int column, int row, int n, double r2);
  int segment_of(int plane, int column, int row) const {
    return segment_at_[static_cast<std::size_t>(plane)]
                      [static_cast<std::size_t>(row * grid_->columns + column)] -
           1;
  }
  void describe(const CameraModel& camera, int segment, PlaneSegment& out) const;

  const CellGrid* grid_ = nullptr;
  std::vector<DisparityPlane> planes_;
  std::vector<int> plane_of_;            // plane of each segment
  std::vector<std::vector<int>> cells_;  // cells of each segment
  // Per cell: bit set of the planes in this cell and in adjacent cells.
  std::vector<std::uint16_t> mask_;
  // For each plane and cell: number of the segment, counted from 1; 0: no segment.
  std::vector<std::vector<std::uint8_t>> segment_at_;
  std::vector<Sums> sums_;
  // For each pixel column of a run of cells: sum of the squared residuals of the labeled pixels, px^2.
  std::vector<float> square_;
  std::vector<int> count_;  // for each pixel column of a run of cells: number of labeled pixels
};

}  // namespace kaz::vision
