// The two pixel loops of plane segmentation. They use the processor's widest vectors; for tests, vectors can
// be disabled. Results are the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kaz::vision {

// Disparities at or above this value, or not above 0, are unknown.
constexpr float kMaxDisparity_px = 1e9F;

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

// Labels the pixels of a row. Pixels within `tolerance` of the disparity start + slope x get the label, other
// pixels 0. Adds the labeled pixels to each column's count and sum of squared residuals.
struct RowPlane {
  float start, slope, tolerance;
  std::uint8_t label;
};
void label_row(const float* disparity, std::size_t pixels, const RowPlane& plane,
               std::uint8_t* labels, float* square, int* count, bool vectors = true);

}  // namespace kaz::vision
