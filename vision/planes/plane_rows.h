// The two pixel loops of plane segmentation. Both loops use AVX2 vectors if the processor has AVX2. Tests can
// disable vectors; the results are the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kaz::vision {

// A disparity is known if the disparity is above 0 and below `kMaxDisparity_px`.
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

// Labels the pixels of a row. A pixel in column x gets `label` if its disparity is above 0 and within
// `tolerance` of `start + slope * x`. Other pixels get label 0. If the pixel in column x gets `label`,
// `count[x]` increases by 1, and `square[x]` increases by the squared difference.
struct RowPlane {
  float start, slope, tolerance;
  std::uint8_t label;
};
void label_row(const float* disparity, std::size_t pixels, const RowPlane& plane,
               std::uint8_t* labels, float* square, int* count, bool vectors = true);

}  // namespace kaz::vision
