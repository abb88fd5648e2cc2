// Masks out blocks that do not determine a disparity because all edges in the block run along the rows.
// SPDX-License-Identifier: Apache-2.0
//
// All points along an edge look alike (the aperture problem), and matching searches only along the rows. If
// the right picture is displaced vertically by e px, the disparity of the best match changes by dd px. A
// least-squares fit over the block yields dd:
//
//   dd = e Sxy / Sxx,   Sxx = sum of gx^2, Sxy = sum of gx gy
//
// Here gx is the derivative along the row, and gy the derivative across the row. Shi and Tomasi use the same
// sums in "Good features to track", CVPR 1994. Edges of a checkered floor may run nearly along the rows. For
// such edges, e = 1/3 px changes the disparity by several px. The computed points are then centimeters off
// the floor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

// Maximum |Sxy| / Sxx of a block that determines a disparity. At this value, e = 1/3 px changes the disparity
// by 1 px.
inline constexpr int kMaxAlong = 3;

class BlockAperture {
 public:
  // Clears the pixels of `mask` (width x height) whose block does not determine a disparity. `block` is the
  // side of a block, px. The derivative in the first and last column is taken as 0. Pixels less than half a
  // block from a border stay unchanged. Results are the same with and without vectors.
  void clear(const std::uint8_t* grey, int width, int height, int block, bool vectors,
             std::vector<std::uint8_t>& mask);

 private:
  std::vector<std::int32_t> products_;  // gx^2 and gx gy of each pixel in the rows of the block
  // For each column: sums of the elements of `products_` over the rows of the block.
  std::vector<std::int32_t> columns_;
};

}  // namespace kaz::vision
