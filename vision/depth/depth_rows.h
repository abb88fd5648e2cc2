// The loops over pixels and disparities that block matching needs, with the widest vectors there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "vision/depth/depth_blocks.h"

namespace kaz::vision {

void filter_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                int width, std::uint8_t* to, bool vectors);

// Per column: the disparity of least cost, that cost and those beside it.
struct RowWinners {
  std::int16_t *disparity, *cost, *before, *after, *in_doubt;
};

// Of winners u .. end - 1, all but the way back. Between pixels a match is where the costs beside
// the least one put it, if they rise as evenly as sums of absolute differences do.
struct RowMatches {
  float* disparity;
  std::int16_t* cost;
  std::uint8_t* good;
};
void judge_row(const RowWinners& winners, const std::uint8_t* wanted, int begin, int end,
               int disparities, int doubt_share, const RowMatches& to, bool vectors);

// One more row of both pictures under the blocks, and the one that leaves them.
struct BlockRow {
  int width, disparities, half;
  const std::uint8_t *left, *right;            // right: mirrored
  const std::uint8_t *left_gone, *right_gone;  // zero where none leaves
  std::int16_t* columns;  // per column and disparity: sum over the block's rows
  std::int16_t* window;   // per disparity; before and after them INT16_MAX
  std::int16_t *right_cost, *right_disparity;  // winners of the right picture, mirrored
  int doubt_share;                             // of 65536
  RowWinners* winners;         // of the block's middle row; none while the block is not full
  const std::uint8_t* wanted;  // of that row: 0 where no winner is needed
};
void match_row(const BlockRow& row, bool vectors);

// How much another disparity may cost and still leave the winner in doubt; `share` of 65536.
inline int doubt(int least, int share) {
  const int limit = least + ((least * share) >> 16);
  return limit < INT16_MAX ? limit : INT16_MAX - 1;
}

// A winner of the left picture, and how many costs leave it in doubt, its own and its neighbours'
// among them. The right picture's pixel goes to whichever winner costs least: no branch, for no
// processor could foretell it.
[[gnu::always_inline]] inline void put_winner(const BlockRow& r, int u, int d, int least,
                                              int in_doubt) {
  const RowWinners& to = *r.winners;
  to.disparity[u] = static_cast<std::int16_t>(d);
  to.cost[u] = static_cast<std::int16_t>(least);
  to.before[u] = r.window[d - 1];
  to.after[u] = r.window[d + 1];
  to.in_doubt[u] = static_cast<std::int16_t>(in_doubt);
  const int other = r.width - 1 - u + d;
  const std::int16_t cost = r.right_cost[other], disparity = r.right_disparity[other];
  const bool claims = least < cost;
  r.right_cost[other] = claims ? static_cast<std::int16_t>(least) : cost;
  r.right_disparity[other] = claims ? static_cast<std::int16_t>(d) : disparity;
}

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_DEPTH_AVX2
// For processors that have AVX2.
void match_row_avx2(const BlockRow& row);
#endif

}  // namespace kaz::vision
