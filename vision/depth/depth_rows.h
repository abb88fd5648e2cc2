// Inner loops of block matching over pixels and disparities. Plain and AVX2 code give equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

// Winner of each column: the disparity d of minimum cost C(d), and the costs C(d), C(d - 1) and C(d + 1).
// `in_doubt` is the number of disparities with costs up to the uniqueness threshold doubt(). The winner d is
// one of these disparities. If no winner was wanted for a column, the entries of the column are undefined.
struct RowWinners {
  std::int16_t *disparity, *cost, *before, *after, *in_doubt;
};

// Input of one step of the running sums. In each step, one row of both pictures enters the blocks, and an
// earlier row leaves the blocks.
struct BlockRow {
  int width, disparities, half;
  const std::uint8_t *left, *right;            // entering rows; right: mirrored
  const std::uint8_t *left_gone, *right_gone;  // leaving rows; all 0 if no row leaves yet
  std::int16_t* columns;  // per column and disparity: sum over the rows of the block
  // For each disparity: sum over the block. The elements before the first and after the last disparity are
  // INT16_MAX.
  std::int16_t* window;
  std::int16_t* windows;  // copy of `window` for each column; only used with 16 disparities
  // The vector code stores the disparities in another order: disparity d has the index place[d] in `columns`
  // and `window`.
  const std::int16_t* place;
  // Several columns of the left picture may match the same column of the mirrored right picture. For each
  // column of the right picture, `claims` contains the best match. The cost C(d) is in the upper 16 bits, and
  // the disparity d is in the lower 16 bits. If costs are equal, the smallest d is best. If there is no match
  // yet, all bits are 1.
  std::uint32_t* claims;
  int doubt_share;             // uniqueness margin in units of 1/65536 of the minimum cost
  bool full;                   // true: the entering row completes the blocks, and winners are found
  RowWinners winners;          // winners of the middle row
  const std::uint8_t* wanted;  // by pixel of the middle row: 0 if no winner is needed
};
void match_row(const BlockRow& row, bool vectors);

// Returns the uniqueness threshold for a winner with the cost `min_cost`. If a disparity more than 1 px away
// from the winner has a cost up to the threshold, the winner is not unique. The threshold is `min_cost * (1 +
// share / 65536)`, but at most INT16_MAX - 1.
inline int doubt(int min_cost, int share) {
  const int limit = min_cost + ((min_cost * share) >> 16);
  return limit < INT16_MAX ? limit : INT16_MAX - 1;
}

// With disparity d, column u of the left picture matches a column of the right picture. Stores this match for
// the column of the right picture, unless a better match is already stored. The code is branch-free, because
// a branch would be unpredictable.
[[gnu::always_inline]] inline void claim(const BlockRow& r, int u, int d, int min_cost) {
  std::uint32_t& other = r.claims[r.width - 1 - u + d];
  other =
      std::min(other, static_cast<std::uint32_t>(min_cost) << 16 | static_cast<std::uint32_t>(d));
}

// A matched row and the winners of the row: input of judge().
struct MatchedRow {
  int width, half, disparities, doubt_share, left_right_px;
  RowWinners winners;
  const std::uint8_t* wanted;
  const std::uint32_t* claims;
};

// Computes the subpixel disparity (px) of the winner d of column u, and returns whether the match is good.
// Let p be the cost `C(d - 1)`, and let q be the cost `C(d + 1)`. SAD costs rise linearly on both sides of
// the minimum. Therefore the minimum is at this disparity: `d + (p - q) / (2 * (max(p, q) - C(d)))`. A match
// is good if all of these hold:
// - A match is wanted at column u, and d is not at an end of the range.
// - Every disparity other than d - 1, d and d + 1 has a cost above the uniqueness threshold doubt().
// - The winner of the matched pixel of the right picture is within `left_right_px` of d.
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

// Writes the results of fronto-parallel blocks: the disparity (px) of each good match, disparity 0 for all
// other pixels, and the costs of all pixels. A match is not good if the right block extends beyond the left
// border of the right picture.
void take_row(const MatchedRow& row, float* disparity, std::int16_t* cost, bool vectors);

constexpr int kAround = 16;  // number of disparities compared around a plane
// Maximum distance of a slanted match from the plane. A match farther away is not on the plane, so the slant
// at the match is unknown.
constexpr float kOn_px = 1;
// Maximum distance of a fronto-parallel match from the plane. A match farther away belongs to another object.
constexpr float kNear_px = 3;
// Maximum cost of a slanted block relative to the cost of the fronto-parallel block. The slanted cost is the
// minimum over kAround disparities; the fronto-parallel cost is the minimum over all disparities. With noise,
// the minimum over all disparities is often smaller than the minimum over kAround disparities. Therefore a
// correct slanted block may cost more than the fronto-parallel block.
constexpr int kMaxCost_percent = 125;

// Marks in `wanted` the pixels of row v that may lie on the plane. Returns whether any pixel is marked.
bool near_row(const DisparityPlane& plane, int v, const float* disparity,
              const std::uint8_t* textured, int width, std::uint8_t* wanted, bool vectors);

// Evaluates the matches of blocks that are slanted like the plane. A good match on the plane replaces
// disparity and cost of the pixel. The right picture was warped so that points of the plane have disparity
// kAround / 2. Therefore the function subtracts kAround / 2 from the disparity of a match, and adds the
// plane's disparity at the matched column.
void take_slanted_row(const MatchedRow& row, const DisparityPlane& plane, int v, float* disparity,
                      std::int16_t* cost, bool vectors);

}  // namespace kaz::vision
