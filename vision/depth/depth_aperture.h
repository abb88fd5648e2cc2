// Masks out blocks whose edges do not fix a disparity, because they run only along the rows.
// SPDX-License-Identifier: Apache-2.0
//
// All points along an edge look alike (the aperture problem), and matching compares along the rows. If the
// right picture is e px higher or lower than rectified, the best match moves by dd, by least squares over the
// block:
//
//   dd = e Sxy / Sxx,   Sxx = sum of gx^2, Sxy = sum of gx gy
//
// gx is the derivative along the row and gy across it (J. Shi, C. Tomasi, "Good features to track", CVPR
// 1994, uses the same sums). Edges of a checkered floor may run nearly along the rows. There, e of a third of
// a pixel moves points by several px of disparity: centimeters out of the floor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

// Largest |Sxy| / Sxx of a block that fixes a disparity: 1 px of disparity at a third of a pixel of e.
inline constexpr int kMaxAlong = 3;

class BlockAperture {
 public:
  // Clears the pixels of `mask` (width x height) whose block does not fix a disparity. `block` is the side of
  // a block, px. The first and last column count as having no derivative. Pixels less than half a block from
  // a border stay as they are. Results are the same with and without vectors.
  void clear(const std::uint8_t* grey, int width, int height, int block, bool vectors,
             std::vector<std::uint8_t>& mask);

 private:
  std::vector<std::int32_t> products_;  // gx^2 and gx gy of the rows of the block
  std::vector<std::int32_t> columns_;   // sums of products_ over these rows, by column
};

}  // namespace kaz::vision
