// Inner loops of block matching over pixels and disparities, plain and with AVX2; equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "vision/depth/depth_blocks.h"

namespace kaz::vision {

// One row of the horizontal 3 x 3 Sobel derivative (depth_blocks.h, FilteredPicture): with columns l = u - 1
// and r = u + 1, clamp(above[r] - above[l] + 2 (here[r] - here[l]) + below[r] - below[l], +-kFilterCap)
// + kFilterCap. The first and last pixel get derivative 0.
void filter_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                int width, std::uint8_t* to, bool vectors);

// Per column: the disparity d of minimum cost, that cost C(d), C(d - 1) and C(d + 1), and how many
// disparities have a cost below the uniqueness threshold doubt(), d included.
struct RowWinners {
  std::int16_t *disparity, *cost, *before, *after, *in_doubt;
};

// Subpixel interpolation and uniqueness of the winners in columns begin .. end - 1; the left-right check
// follows elsewhere. SAD costs rise linearly on both sides of the minimum. With p = C(d - 1), q = C(d + 1):
//   disparity = d + (p - q) / (2 (max(p, q) - C(d))), px.
// `good`: 1 where d is not at an end of the range, no disparity other than d - 1 and d + 1 is in doubt, and
// the pixel is wanted.
struct RowMatches {
  float* disparity;
  std::int16_t* cost;
  std::uint8_t* good;
};
void judge_row(const RowWinners& winners, const std::uint8_t* wanted, int begin, int end,
               int disparities, int doubt_share, const RowMatches& to, bool vectors);

// One step of the running sums: the row of both pictures that enters the blocks, and the one that leaves.
struct BlockRow {
  int width, disparities, half;
  const std::uint8_t *left, *right;            // right: mirrored
  const std::uint8_t *left_gone, *right_gone;  // all 0 where none leaves
  std::int16_t* columns;  // per column and disparity: sum over the block's rows
  std::int16_t* window;   // per disparity: sum over the block; INT16_MAX at both ends
  std::int16_t *right_cost, *right_disparity;  // winners of the right picture, mirrored
  int doubt_share;                             // of 65536
  RowWinners* winners;         // of the block's middle row; null while the block is not full
  const std::uint8_t* wanted;  // of that row: 0 where no winner is needed
};
void match_row(const BlockRow& row, bool vectors);

// Uniqueness threshold: costs up to min_cost (1 + share / 65536) put the winner in doubt.
inline int doubt(int min_cost, int share) {
  const int limit = min_cost + ((min_cost * share) >> 16);
  return limit < INT16_MAX ? limit : INT16_MAX - 1;
}

// Stores the winner d of the left picture's column u, with the number of costs that put it in doubt, its own
// and its neighbours' among them. The matching pixel of the right picture (mirrored column) takes the winner
// of minimum cost. Without branches, because branch prediction fails here.
[[gnu::always_inline]] inline void put_winner(const BlockRow& r, int u, int d, int min_cost,
                                              int in_doubt) {
  const RowWinners& to = *r.winners;
  to.disparity[u] = static_cast<std::int16_t>(d);
  to.cost[u] = static_cast<std::int16_t>(min_cost);
  to.before[u] = r.window[d - 1];
  to.after[u] = r.window[d + 1];
  to.in_doubt[u] = static_cast<std::int16_t>(in_doubt);
  const int other = r.width - 1 - u + d;
  const std::int16_t cost = r.right_cost[other], disparity = r.right_disparity[other];
  const bool claims = min_cost < cost;
  r.right_cost[other] = claims ? static_cast<std::int16_t>(min_cost) : cost;
  r.right_disparity[other] = claims ? static_cast<std::int16_t>(d) : disparity;
}

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_DEPTH_AVX2
// For processors that have AVX2.
void match_row_avx2(const BlockRow& row);
#endif

}  // namespace kaz::vision
