// The two loops over all pixels that plane segments need, with the processor's widest vectors
// or, for tests, without: the results are the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kaz::vision {

constexpr float kMaxDisparity_px = 1e9F;  // from there on, as from 0 down, it counts as unknown

// What is known of columns of pixels over several rows.
struct ColumnSums {
  float* sum;  // of disparities
  float* min;  // kMaxDisparity_px where none is known
  float* max;  // 0 where none is known
  int* count;
};
void add_row(const float* disparity, std::size_t pixels, const ColumnSums& sums,
             bool vectors = true);

// Pixels within `tolerance` of the disparity start + slope x get the label, others 0. Adds to each
// column's sum of squares and count.
struct RowPlane {
  float start, slope, tolerance;
  std::uint8_t label;
};
void label_row(const float* disparity, std::size_t pixels, const RowPlane& plane,
               std::uint8_t* labels, float* square, int* count, bool vectors = true);

}  // namespace kaz::vision
