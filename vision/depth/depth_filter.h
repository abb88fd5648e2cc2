// Filters rows of pictures for block matching. Plain and AVX2 code give equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::vision {

constexpr int kFilterCap = 31;  // filtered codes are integers from 0 to 2 * kFilterCap
// This number of elements must follow the last row in memory, because vector loads may read beyond the row.
// The values of these elements are not used.
constexpr int kVectorMargin = 32;

// Computes one row of the horizontal 3 x 3 Sobel derivative (depth_blocks.h, FilteredPicture). With the
// columns l = u - 1 and r = u + 1, a code is
//   clamp(above[r] - above[l] + 2 (here[r] - here[l]) + below[r] - below[l], +-kFilterCap) + kFilterCap.
// The first and last pixel get derivative 0.
void filter_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                int width, std::uint8_t* to, bool vectors);

// Reverses the order of the codes of a row.
void mirror_row(const std::uint8_t* from, int width, std::uint8_t* to, bool vectors);

// Interpolates a row linearly at the positions `at`, `at + step`, `at + 2 step` and so on, in 16.16 fixed
// point. The `count` interpolated codes are written in reverse order, the last code first. Let p be the code
// left of the position, r the code right of the position, and s the 8-bit fraction. Then the interpolated
// code is (p (256 - s) + r s + 128) >> 8. Positions outside 0 .. width - 1 give the code kFilterCap.
struct WarpRow {
  const std::uint8_t* from;
  int width;
  std::int64_t at;
  int step;  // greater than 0
  std::uint8_t* to;
  int count;
};
void warp_row(const WarpRow& row, bool vectors);

// One step of the running sums of absolute derivatives. `in` is the row that enters the blocks. `gone` is the
// row that leaves the blocks. In the first `block` steps, no row leaves the blocks. In these steps, all
// codes of `gone` must be kFilterCap, the code of the derivative 0. `columns` contains the sum of each
// column; the caller must keep these sums from row to row. `textured` is the mask of the middle row of the
// blocks: 1 where the sum over the block is at least `min_sum`. The mask is not written within half a block
// of the borders. As long as fewer than `block` rows have entered, `textured` must be null.
struct TextureRow {
  const std::uint8_t *in, *gone;
  int width, block, min_sum;
  std::int16_t* columns;
  std::uint8_t* textured;
};
void texture_row(const TextureRow& row, bool vectors);

}  // namespace kaz::vision
