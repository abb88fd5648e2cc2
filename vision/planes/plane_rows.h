// The two pixel loops of plane segmentation. Both loops use the processor's widest vectors. Tests can disable
// vectors; the results are the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kaz::vision {

// A disparity is known only if the disparity is above 0 and below this value.
constexpr float kMaxDisparity_px = 1e9F;

// Statistics of the known disparities of each pixel column over several rows.
struct ColumnSums {
  float* sum;  // sum of the disparities
  float* min;  // smallest disparity; kMaxDisparity_px if no disparity is known
  float* max;  // largest disparity; 0 if no disparity is known
  int* count;
};

// Adds a row of disparities to `sums`.
void add_row(const float* disparity, std::size_t pixels, const ColumnSums& sums,
             bool vectors = true);

// Labels the pixels of a row. A pixel in column x gets `label` if the difference between the pixel's
// disparity and `start + slope * x` is less than `tolerance`. Other pixels get label 0. Adds the labeled
// pixels to each column's count and sum of squared residuals.
struct RowPlane {
  float start, slope, tolerance;
  std::uint8_t label;
};
void label_row(const float* disparity, std::size_t pixels, const RowPlane& plane,
               std::uint8_t* labels, float* square, int* count, bool vectors = true);

}  // namespace kaz::vision
