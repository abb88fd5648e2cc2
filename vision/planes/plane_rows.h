// The two pixel loops of plane segmentation, with the processor's widest vectors or, for tests, without.
// Results are the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kaz::vision {

constexpr float kMaxDisparity_px = 1e9F;  // values from here on, or not above 0, are unknown

// Statistics of the known disparities of each pixel column over several rows.
struct ColumnSums {
  float* sum;  // sum of the disparities
  float* min;  // kMaxDisparity_px if none is known
  float* max;  // 0 if none is known
  int* count;
};

// Adds a row of disparities to `sums`.
void add_row(const float* disparity, std::size_t pixels, const ColumnSums& sums,
             bool vectors = true);

// Labels the pixels of a row. Those within `tolerance` of the disparity start + slope x get the label, others
// 0. Adds to the sum of squared residuals and the count of each column.
struct RowPlane {
  float start, slope, tolerance;
  std::uint8_t label;
};
void label_row(const float* disparity, std::size_t pixels, const RowPlane& plane,
               std::uint8_t* labels, float* square, int* count, bool vectors = true);

}  // namespace kaz::vision
