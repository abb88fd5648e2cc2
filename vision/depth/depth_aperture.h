// Mask of the blocks whose edges fix a disparity: not those that have only edges along the rows.
// SPDX-License-Identifier: Apache-2.0
//
// Along an edge all points look alike (the aperture problem), and matching compares along the rows. If the
// right picture is e px higher or lower than rectified, the best match moves by least squares over the block
// by
//
//   dd = e Sxy / Sxx,   Sxx = sum of gx^2, Sxy = sum of gx gy
//
// with the derivatives gx along the row and gy across (J. Shi, C. Tomasi, "Good features to track", CVPR
// 1994, the same sums). At a checkered floor's edges that run nearly along the rows, a third of a pixel of e
// moves points by several px of disparity: centimetres, out of the floor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::vision {

// Largest |Sxy| / Sxx of a block that fixes a disparity: 1 px of disparity at a third of a pixel of e.
inline constexpr int kMaxAlong = 3;

class BlockAperture {
 public:
  // Clears the pixels of `mask`, width x height, whose block of the side `block` does not fix a disparity.
  // The picture's borders count as without derivative; pixels nearer to them than half a block are left as
  // they are. Same result with vectors and without.
  void clear(const std::uint8_t* grey, int width, int height, int block, bool vectors,
             std::vector<std::uint8_t>& mask);

 private:
  std::vector<std::int32_t> products_;  // gx^2 and gx gy of the block's rows
  std::vector<std::int32_t> columns_;   // their sums over these rows, by column
};

}  // namespace kaz::vision
