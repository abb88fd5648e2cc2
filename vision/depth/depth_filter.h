// Rows of filtered pictures before block matching, plain and with AVX2; equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::vision {

constexpr int kFilterCap = 31;  // codes of the filtered picture: 0..2 kFilterCap
// Bytes and numbers that may be read, never used, beyond the last row: vectors are loaded whole.
constexpr int kVectorMargin = 32;

// One row of the horizontal 3 x 3 Sobel derivative (depth_blocks.h, FilteredPicture): with columns l = u - 1
// and r = u + 1, clamp(above[r] - above[l] + 2 (here[r] - here[l]) + below[r] - below[l], +-kFilterCap)
// + kFilterCap. The first and last pixel get derivative 0.
void filter_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                int width, std::uint8_t* to, bool vectors);

// The same codes from the last to the first.
void mirror_row(const std::uint8_t* from, int width, std::uint8_t* to, bool vectors);

// Linear interpolation at the positions at, at + step, ... in 16.16 fixed point, written from the last of
// `count` codes to the first: with p = from[at >> 16], its neighbour r and the 8 bit part s of the position,
// (p (256 - s) + r s + 128) >> 8; kFilterCap outside of 0 .. width - 1.
struct WarpRow {
  const std::uint8_t* from;
  int width;
  std::int64_t at;
  int step;  // above 0
  std::uint8_t* to;
  int count;
};
void warp_row(const WarpRow& row, bool vectors);

// One step of the running sums of absolute derivatives: the row that enters the blocks and the one that
// leaves (codes kFilterCap where none does). `columns`: per column, kept from row to row. `textured`, of the
// blocks' middle row: 1 where the sum over the block is at least `min_sum`; not written within half a block
// of the borders. Null while the blocks are not full.
struct TextureRow {
  const std::uint8_t *in, *gone;
  int width, block, min_sum;
  std::int16_t* columns;
  std::uint8_t* textured;
};
void texture_row(const TextureRow& row, bool vectors);

}  // namespace kaz::vision
