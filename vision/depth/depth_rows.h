// Inner loops of block matching over pixels and disparities, plain and with AVX2; equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

// By column: the disparity d of minimum cost, that cost C(d), C(d - 1) and C(d + 1), and how many disparities
// have a cost below the uniqueness threshold doubt(), d included. Only where a winner was wanted.
struct RowWinners {
  std::int16_t *disparity, *cost, *before, *after, *in_doubt;
};

// One step of the running sums: the row of both pictures that enters the blocks, and the one that leaves.
struct BlockRow {
  int width, disparities, half;
  const std::uint8_t *left, *right;            // right: mirrored
  const std::uint8_t *left_gone, *right_gone;  // all 0 where none leaves
  std::int16_t* columns;  // per column and disparity: sum over the block's rows
  std::int16_t* window;   // per disparity: sum over the block; INT16_MAX at both ends
  std::int16_t* windows;  // the same for each column, where there are 16 disparities
  // With vectors, `columns` and `window` have disparity d at place[d].
  const std::int16_t* place;
  // By column of the right picture, mirrored: C(d) << 16 | d of the winner of minimum cost that matches
  // there, of equal ones the smallest d. All ones before the first.
  std::uint32_t* claims;
  int doubt_share;             // of 65536
  bool full;                   // the block has all its rows: winners are found for its middle row
  RowWinners winners;          // of that row
  const std::uint8_t* wanted;  // of that row: 0 where no winner is needed
};
void match_row(const BlockRow& row, bool vectors);

// Uniqueness threshold: costs up to min_cost (1 + share / 65536) put the winner in doubt.
inline int doubt(int min_cost, int share) {
  const int limit = min_cost + ((min_cost * share) >> 16);
  return limit < INT16_MAX ? limit : INT16_MAX - 1;
}

// The winner d of the left picture's column u claims the pixel of the right picture that it matches. Without
// branches, because branch prediction fails here.
[[gnu::always_inline]] inline void claim(const BlockRow& r, int u, int d, int min_cost) {
  std::uint32_t& other = r.claims[r.width - 1 - u + d];
  other =
      std::min(other, static_cast<std::uint32_t>(min_cost) << 16 | static_cast<std::uint32_t>(d));
}

// A row with its winners, to be judged: a match is good if it is wanted, its disparity is not at an end of
// the range, no disparity but d - 1 and d + 1 is in doubt, and the right picture's winner there is within
// `left_right_px` of it. SAD costs rise linearly on both sides of the minimum, so with p = C(d - 1) and
// q = C(d + 1) the disparity is d + (p - q) / (2 (max(p, q) - C(d))), px.
struct MatchedRow {
  int width, half, disparities, doubt_share, left_right_px;
  RowWinners winners;
  const std::uint8_t* wanted;
  const std::uint32_t* claims;
};
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

// Fronto-parallel blocks: the disparities of good matches whose blocks do not extend beyond the left border
// of the right picture, else 0, px; and all costs.
void take_row(const MatchedRow& row, float* disparity, std::int16_t* cost, bool vectors);

constexpr int kAround = 16;    // disparities compared around a plane
constexpr float kOn_px = 1;    // a result further off the plane is not on it: its slant is unknown
constexpr float kNear_px = 3;  // a fronto-parallel result further off the plane is another object
// Largest cost of a slanted block relative to the fronto-parallel one. The latter is the minimum over all
// disparities, the former over kAround: with noise, the minimum of more values is smaller.
constexpr int kMaxCost_percent = 125;

// Pixels of row v where the plane is possible; returns whether there are any.
bool near_row(const DisparityPlane& plane, int v, const float* disparity,
              const std::uint8_t* textured, int width, std::uint8_t* wanted, bool vectors);

// Blocks slanted like the plane, whose points have disparity kAround / 2 in the warped picture: good matches
// on the plane replace disparity and cost. Undoes the warp: total disparity = residual disparity + the
// plane's at the warped pixel.
void take_slanted_row(const MatchedRow& row, const DisparityPlane& plane, int v, float* disparity,
                      std::int16_t* cost, bool vectors);

}  // namespace kaz::vision
