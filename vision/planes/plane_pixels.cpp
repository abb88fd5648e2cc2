// Labels of pixels and geometry of plane segments.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/plane_pixels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "vision/planes/plane_rows.h"

namespace kaz::vision {

void PlanePixels::begin(const CellGrid& grid) {
  grid_ = &grid;
  planes_.clear();
  plane_of_.clear();
  cells_.clear();
  mask_.assign(grid.cells.size(), 0);
}

void PlanePixels::add(const DisparityPlane& plane, const std::vector<std::vector<int>>& parts) {
  const auto number = planes_.size();
  planes_.push_back(plane);
  if (segment_at_.size() <= number) segment_at_.emplace_back();
  auto& at = segment_at_[number];
  at.assign(grid_->cells.size(), 0);
  for (const auto& part : parts) {
    if (plane_of_.size() == 255) return;  // a label is a byte; the largest of each plane come first
    plane_of_.push_back(static_cast<int>(number));
    cells_.push_back(part);
    const auto label = static_cast<std::uint8_t>(plane_of_.size());
    for (const int i : part) {
      at[static_cast<std::size_t>(i)] = label;
      mask_[static_cast<std::size_t>(i)] |= static_cast<std::uint16_t>(1U << number);
    }
    // Adjacent cells may contain pixels of it, at the border of a nearer object.
    for (const int i : part) {
      const int columns = grid_->columns, column = i % columns, row = i / columns;
      if (column > 0 && row > 0 && column + 1 < columns && row + 1 < grid_->rows) {
        const std::uint8_t *here = &at[static_cast<std::size_t>(i)], *up = here - columns,
                           *down = here + columns;
        if (up[-1] == label && up[0] == label && up[1] == label && here[-1] == label &&
            here[1] == label && down[-1] == label && down[0] == label && down[1] == label)
          continue;
      }
      for (int y = std::max(0, row - 1); y <= std::min(grid_->rows - 1, row + 1); ++y) {
        for (int x = std::max(0, column - 1); x <= std::min(columns - 1, column + 1); ++x) {
          const auto j = static_cast<std::size_t>(y * columns + x);
          if (at[j] == 0) at[j] = label;
          mask_[j] |= static_cast<std::uint16_t>(1U << number);
        }
      }
    }
  }
}

void PlanePixels::accumulate(int segment, int column, int row, int n, double r2) {
  if (n == 0) return;
  const int size = grid_->size;
  Sums& s = sums_[static_cast<std::size_t>(segment)];
  s.pixels += n;
  s.left = std::min(s.left, column * size);
  s.right = std::max(s.right, (column + 1) * size - 1);
  s.top = std::min(s.top, row * size);
  s.bottom = std::max(s.bottom, (row + 1) * size - 1);
  s.r2 += r2;
  const int plane = plane_of_[static_cast<std::size_t>(segment)];
  // Relative depth error of a pixel: dz / z = dd / d, with the plane's disparity d at the cell's centre.
  const double d = std::max(0.25, static_cast<double>(planes_[static_cast<std::size_t>(plane)].at(
                                      static_cast<float>(column * size + size / 2) - grid_->cx,
                                      static_cast<float>(row * size + size / 2) - grid_->cy)));
  s.relative2 += r2 / (d * d);
}

// Adjacent cells of one row with the same single plane and segment: processed as whole rows of pixels, so
// that the loop vectorises.
void PlanePixels::assign_run(const DepthImage& depth, int column, int end, int row, float tolerance,
                             PlaneSegments& found) {
  const int plane =
      std::countr_zero(mask_[static_cast<std::size_t>(row * grid_->columns + column)]);
  const int segment = segment_of(plane, column, row);
  const auto label = static_cast<std::uint8_t>(segment + 1);
  const DisparityPlane p = planes_[static_cast<std::size_t>(plane)];
  const int size = grid_->size, width = (end - column) * size;
  square_.assign(static_cast<std::size_t>(width), 0);
  count_.assign(static_cast<std::size_t>(width), 0);
  float* square = square_.data();
  int* count = count_.data();
  for (int y = row * size; y < (row + 1) * size; ++y) {
    const auto first = static_cast<std::size_t>(y) * static_cast<std::size_t>(depth.width) +
                       static_cast<std::size_t>(column * size);
    const float* from = &depth.disparity_px[first];
    std::uint8_t* to = &found.label[first];
    const float start =
        p.at(static_cast<float>(column * size) - grid_->cx, static_cast<float>(y) - grid_->cy);
    label_row(from, static_cast<std::size_t>(width), {start, p.a, tolerance, label}, to, square,
              count);
  }
  for (int c = column; c < end; ++c) {
    int n = 0;
    float r2 = 0;
    for (int x = (c - column) * size; x < (c - column + 1) * size; ++x) {
      n += count[x];
      r2 += square[x];
    }
    accumulate(segment, c, row, n, static_cast<double>(r2));
  }
}

void PlanePixels::assign_cell(const DepthImage& depth, int column, int row, float tolerance,
                              PlaneSegments& found) {
  const auto at = static_cast<std::size_t>(row * grid_->columns + column);
  const int size = grid_->size;
  struct Near {
    int segment;
    float start, a, b;  // disparity at the cell's first pixel, and its slopes
  };
  std::array<Near, kMaxPlanes> near;
  std::array<CellSums, kMaxPlanes> sums;
  int count = 0;
  for (int k = 0; k < planes(); ++k) {
    if ((mask_[at] >> k & 1) == 0) continue;
    const DisparityPlane& p = planes_[static_cast<std::size_t>(k)];
    const float start = p.at(static_cast<float>(column * size) - grid_->cx,
                             static_cast<float>(row * size) - grid_->cy);
    near[static_cast<std::size_t>(count)] = {segment_of(k, column, row), start, p.a, p.b};
    sums[static_cast<std::size_t>(count++)] = {};
  }
  for (int y = 0; y < size; ++y) {
    const auto first =
        static_cast<std::size_t>(row * size + y) * static_cast<std::size_t>(depth.width) +
        static_cast<std::size_t>(column * size);
    for (int x = 0; x < size; ++x) {
      const float d = depth.disparity_px[first + static_cast<std::size_t>(x)];
      float best = tolerance;
      int nearest = -1;
      for (int k = 0; k < count; ++k) {
        const Near& n = near[static_cast<std::size_t>(k)];
        const float r = d - (n.start + n.a * static_cast<float>(x) + n.b * static_cast<float>(y));
        if (std::abs(r) < std::abs(best)) {
          best = r;
          nearest = k;
        }
      }
      if (nearest < 0 || !(d > 0)) continue;
      found.label[first + static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(near[static_cast<std::size_t>(nearest)].segment + 1);
      CellSums& s = sums[static_cast<std::size_t>(nearest)];
      ++s.n;
      s.r2 += best * best;
    }
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
    accumulate(near[k].segment, column, row, sums[k].n, static_cast<double>(sums[k].r2));
}

void PlanePixels::describe(const CameraModel& camera, int segment, PlaneSegment& out) const {
  const auto index = static_cast<std::size_t>(segment);
  const Sums& s = sums_[index];
  out.plane = plane_of_[index];
  const DisparityPlane& plane = planes_[static_cast<std::size_t>(out.plane)];
  // scaled = B/D n (disparity_plane.h): unit normal towards the camera and distance D = B / |scaled|, m.
  const Eigen::Vector3d scaled = plane.scaled_normal(camera);
  out.normal = -scaled.normalized();
  out.distance_m = camera.baseline_m / scaled.norm();
  out.pixels = s.pixels;
  out.left = s.left;
  out.top = s.top;
  out.right = s.right;
  out.bottom = s.bottom;
  if (s.pixels == 0) return;
  out.error_px = std::sqrt(s.r2 / s.pixels);
  out.error_m = out.distance_m * std::sqrt(s.relative2 / s.pixels);
  // Extent in the plane: cells back-projected to 3-D (optical frame, z = fx B / d) and expressed in an
  // orthonormal basis of the plane, m; principal axes of their covariance; box along these axes.
  const Eigen::Vector3d any = out.normal.unitOrthogonal(), other = out.normal.cross(any);
  std::vector<Eigen::Vector2d> points;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  for (const int i : cells_[index]) {
    const Cell& c = grid_->cells[static_cast<std::size_t>(i)];
    // Relative depth error of a pixel: dz / z = dd / d, with the plane's disparity d at the cell's centre.
    const double d = std::max(0.25, static_cast<double>(plane.at(c.u, c.v)));
    const Eigen::Vector3d p = camera.fx * camera.baseline_m / d *
                              Eigen::Vector3d(static_cast<double>(c.u) / camera.fx,
                                              static_cast<double>(c.v) / camera.fy, 1);
    points.emplace_back(any.dot(p), other.dot(p));
    mean += points.back();
    square += points.back() * points.back().transpose();
  }
  const auto n = static_cast<double>(points.size());
  mean /= n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(square / n - mean * mean.transpose());
  const Eigen::Vector2d longest = axes.eigenvectors().col(1), shortest = axes.eigenvectors().col(0);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d q(longest.dot(p - mean), shortest.dot(p - mean));
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  out.middle = mean.x() * any + mean.y() * other - out.distance_m * out.normal;
  out.along = longest.x() * any + longest.y() * other;
  out.across = shortest.x() * any + shortest.y() * other;
  out.length_m = high.x() - low.x();
  out.width_m = high.y() - low.y();
}

void PlanePixels::assign(const DepthImage& depth, float tolerance, PlaneSegments& found) {
  found.width = depth.width;
  found.height = depth.height;
  found.label.assign(depth.disparity_px.size(), 0);
  found.segments.assign(plane_of_.size(), {});
  sums_.assign(plane_of_.size(), {});
  for (int row = 0; row < grid_->rows; ++row) {
    const std::uint16_t* mask = &mask_[static_cast<std::size_t>(row * grid_->columns)];
    for (int column = 0; column < grid_->columns;) {
      int end = column + 1;
      if (std::has_single_bit(mask[column])) {
        const int plane = std::countr_zero(mask[column]);
        while (end < grid_->columns && mask[end] == mask[column] &&
               segment_of(plane, end, row) == segment_of(plane, column, row))
          ++end;
        assign_run(depth, column, end, row, tolerance, found);
      } else if (mask[column] != 0) {
        assign_cell(depth, column, row, tolerance, found);
      }
      column = end;
    }
  }
  for (std::size_t i = 0; i < plane_of_.size(); ++i)
    describe(depth.info.camera, static_cast<int>(i), found.segments[i]);
}

}  // namespace kaz::vision
