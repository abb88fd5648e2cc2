// Filters rows of pictures for block matching. Plain and AVX2 code give equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::vision {

constexpr int kFilterCap = 31;  // codes of the filtered picture are 0 to 2 kFilterCap
// Bytes or numbers beyond the last row that may be read but are never used: whole vectors are loaded.
constexpr int kVectorMargin = 32;

// Computes one row of the horizontal 3 x 3 Sobel derivative (depth_blocks.h, FilteredPicture). With the
// columns l = u - 1 and r = u + 1, a code is
//   clamp(above[r] - above[l] + 2 (here[r] - here[l]) + below[r] - below[l], +-kFilterCap) + kFilterCap.
// The first and last pixel get derivative 0.
void filter_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                int width, std::uint8_t* to, bool vectors);

// Reverses the order of the codes of a row.
void mirror_row(const std::uint8_t* from, int width, std::uint8_t* to, bool vectors);

// Interpolates linearly at the positions at, at + step, ... in 16.16 fixed point. The results are written
// from the last of `count` codes to the first. With p = from[at >> 16], its right neighbor r and the 8-bit
// fraction s, a code is (p (256 - s) + r s + 128) >> 8. Outside of 0 .. width - 1 it is kFilterCap.
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
// one that leaves, with codes kFilterCap while none leaves. `columns` are sums per column, kept from row to
// row. `textured` belongs to the middle row of the blocks: 1 where the sum over the block is at least
// `min_sum`. It is not written within half a block of the borders, and is null while the blocks are not full.
struct TextureRow {
  const std::uint8_t *in, *gone;
  int width, block, min_sum;
  std::int16_t* columns;
  std::uint8_t* textured;
};
void texture_row(const TextureRow& row, bool vectors);

}  // namespace kaz::vision
