// Inner loops of block matching over pixels and disparities. Plain and AVX2 code give equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

// Winners by column: the disparity d of minimum cost, its cost C(d), and C(d - 1) and C(d + 1). `in_doubt` is
// the number of disparities, d included, with costs up to the uniqueness threshold doubt(). Valid only where
// a winner was wanted.
struct RowWinners {
  std::int16_t *disparity, *cost, *before, *after, *in_doubt;
};

// One step of the running sums: the row of both pictures that enters the blocks, and the one that leaves.
struct BlockRow {
  int width, disparities, half;
  const std::uint8_t *left, *right;            // entering rows; right: mirrored
  const std::uint8_t *left_gone, *right_gone;  // leaving rows; all 0 where none leaves
  std::int16_t* columns;  // per column and disparity: sum over the rows of the block
  std::int16_t* window;   // per disparity: sum over the block; INT16_MAX at both ends
  std::int16_t* windows;  // window of each column, if there are 16 disparities
  // With vectors, disparity d is at place[d] in `columns` and `window`.
  const std::int16_t* place;
  // By column of the mirrored right picture: C(d) << 16 | d of the best winner that matches there. The
  // smallest d wins between equal costs. All ones before the first.
  std::uint32_t* claims;
  int doubt_share;             // uniqueness margin in 65536ths
  bool full;                   // the block has all its rows, so winners are found
  RowWinners winners;          // winners of the middle row
  const std::uint8_t* wanted;  // for the middle row: 0 where no winner is needed
};
void match_row(const BlockRow& row, bool vectors);

// Returns the uniqueness threshold. Costs up to min_cost (1 + share / 65536) put the winner in doubt.
inline int doubt(int min_cost, int share) {
  const int limit = min_cost + ((min_cost * share) >> 16);
  return limit < INT16_MAX ? limit : INT16_MAX - 1;
}

// The winner d of the left picture's column u claims the pixel of the right picture that it matches.
// Branch-free, because branch prediction fails here.
[[gnu::always_inline]] inline void claim(const BlockRow& r, int u, int d, int min_cost) {
  std::uint32_t& other = r.claims[r.width - 1 - u + d];
  other =
      std::min(other, static_cast<std::uint32_t>(min_cost) << 16 | static_cast<std::uint32_t>(d));
}

// A row with its winners, as judge() reads it.
struct MatchedRow {
  int width, half, disparities, doubt_share, left_right_px;
  RowWinners winners;
  const std::uint8_t* wanted;
  const std::uint32_t* claims;
};

// Computes the subpixel disparity (px) of the winner d of column u, and returns whether the match is good.
// SAD costs rise linearly on both sides of the minimum. With p = C(d - 1) and q = C(d + 1) the disparity is
// therefore d + (p - q) / (2 (max(p, q) - C(d))). A match is good if all of these hold:
// - It is wanted, and d is not at an end of the range.
// - No disparity except d - 1 and d + 1 is in doubt.
// - The winner of the right picture there is within `left_right_px` of d.
inline bool judge(const MatchedRow& r, int u, float& disparity) {
  const RowWinners& w = r.winners;
  const int d = w.disparity[u], c = w.cost[u], p = w.before[u], q = w.after[u];
  const int limit = doubt(c, r.doubt_share);
  const int own = 1 + (p <= limit ? 1 : 0) + (q <= limit ? 1 : 0);
  const int rise = std::max(1, 2 * (std::max(p, q) - c));
  disparity = static_cast<float>(d) + static_cast<float>(p - q) / static_cast<float>(rise);
  const int other = static_cast<int>(r.claims[r.width - 1 - u + d] & 0xffff);
  return (r.wanted[u] != 0) & (d > 0) & (d < r.disparities - 1) & (w.in_doubt[u] == own) &
         (std::abs(other - d) <= r.left_right_px);
}

// Writes the disparities (px) of good matches of fronto-parallel blocks, else 0, and all costs. A match is
// not good if its block extends beyond the left border of the right picture.
void take_row(const MatchedRow& row, float* disparity, std::int16_t* cost, bool vectors);

constexpr int kAround = 16;  // number of disparities compared around a plane
// Results further off the plane are not on it, so their slant is unknown.
constexpr float kOn_px = 1;
// Fronto-parallel results further off belong to another object.
constexpr float kNear_px = 3;
// Largest cost of a slanted block relative to the fronto-parallel one. The latter is the minimum over all
// disparities, the former over kAround. With noise, the minimum of more values is smaller.
constexpr int kMaxCost_percent = 125;

// Marks the pixels of row v where the plane is possible. Returns whether it marks any.
bool near_row(const DisparityPlane& plane, int v, const float* disparity,
              const std::uint8_t* textured, int width, std::uint8_t* wanted, bool vectors);

// Takes good matches of blocks slanted like the plane: on the plane, they replace disparity and cost. Points
// of the plane have disparity kAround / 2 in the warped picture. Undoes the warp: the disparity is the
// residual disparity plus that of the plane at the warped pixel.
void take_slanted_row(const MatchedRow& row, const DisparityPlane& plane, int v, float* disparity,
                      std::int16_t* cost, bool vectors);

}  // namespace kaz::vision
