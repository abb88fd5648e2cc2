// Mean disparity of square cells, with outlier rejection.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/plane_cells.h"

#include <algorithm>
#include <cmath>

#include "vision/planes/plane_rows.h"

namespace kaz::vision {
namespace {

constexpr float kFar = kMaxDisparity_px;

}  // namespace

void CellGrid::fill(const DepthImage& depth) {
  const int width = depth.width, height = depth.height;
  size = std::max(2, (width + 40) / 80);
  columns = width / size;
  rows = height / size;
  cx = static_cast<float>(depth.info.camera.cx);
  cy = static_cast<float>(depth.info.camera.cy);
  cells.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), Cell{});
  const auto n = static_cast<std::size_t>(columns * size);
  // Largest range of disparity, px, over a cell of one surface: noise plus slope (up to 0.3 px per pixel at
  // the distances of this robot). Above it the cell contains a depth discontinuity or outliers.
  const float spread = 1.5F + 0.3F * static_cast<float>(size);
  for (int row = 0; row < rows; ++row) {
    sum_.assign(n, 0);
    min_.assign(n, kFar);
    max_.assign(n, 0);
    count_.assign(n, 0);
    for (int y = row * size; y < (row + 1) * size; ++y) {
      const float* from =
          &depth.disparity_px[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
      add_row(from, n, {sum_.data(), min_.data(), max_.data(), count_.data()});
    }
    for (int column = 0; column < columns; ++column) {
      Cell& cell = cells[static_cast<std::size_t>(row * columns + column)];
      float sum = 0, min_d = kFar, max_d = 0;
      int count = 0;
      for (std::size_t i = 0, x = static_cast<std::size_t>(column * size);
           i < static_cast<std::size_t>(size); ++i, ++x) {
        sum += sum_[x];
        min_d = std::min(min_d, min_[x]);
        max_d = std::max(max_d, max_[x]);
        count += count_[x];
      }
      if (4 * count < size * size) continue;
      if (count < size * size || max_d - min_d > spread) {
        cell = partly(depth, column, row, spread);
        continue;
      }
      // All pixels valid: their mean position is the cell's centre, px from the principal point.
      const float half = 0.5F * static_cast<float>(size - 1);
      cell = {static_cast<float>(column * size) + half - cx,
              static_cast<float>(row * size) + half - cy, sum / static_cast<float>(count), true};
    }
  }
}

// Mean position and disparity of the pixels within spread / 2 of the median disparity: rejects isolated
// wrong matches. Not usable if these are less than a quarter of the cell or less than three quarters of the
// pixels with depth (a depth discontinuity).
Cell CellGrid::partly(const DepthImage& depth, int column, int row, float spread) {
  known_.clear();
  for (int y = row * size; y < (row + 1) * size; ++y) {
    for (int x = column * size; x < (column + 1) * size; ++x) {
      const float d = depth.disparity(x, y);
      if (d > 0 && d < kFar) known_.push_back({d, static_cast<float>(x), static_cast<float>(y)});
    }
  }
  const auto middle = known_.begin() + static_cast<std::ptrdiff_t>(known_.size() / 2);
  std::nth_element(known_.begin(), middle, known_.end(),
                   [](const auto& a, const auto& b) { return a[0] < b[0]; });
  const float median = (*middle)[0];
  float u = 0, v = 0, sum = 0;
  int count = 0;
  for (const auto& [d, x, y] : known_) {
    if (std::abs(d - median) > 0.5F * spread) continue;
    u += x;
    v += y;
    sum += d;
    ++count;
  }
  if (4 * count < size * size || 4 * count < 3 * static_cast<int>(known_.size())) return {};
  const auto n = static_cast<float>(count);
  return {u / n - cx, v / n - cy, sum / n, true};
}

}  // namespace kaz::vision
