// Integer arithmetic except for the disparities, whose few operations SIMD rounds in the same way.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_rows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "vision/depth/depth_rows_avx2.h"

namespace kaz::vision {
namespace {

// Column sums per disparity: S(u, d) += |L(u) - R(u - d)| of the entering row - the same of the leaving row.
// The right picture is mirrored, so R(u - d) is at index width - 1 - u + d.
void move_column(const BlockRow& r, int u) {
  const int n = r.disparities;
  const auto at = static_cast<std::ptrdiff_t>(r.width - 1 - u);
  const std::uint8_t *in = r.right + at, *out = r.right_gone + at;
  std::int16_t* column = r.columns + static_cast<std::ptrdiff_t>(u) * n;
  const int a = r.left[u], b = r.left_gone[u];
  for (int d = 0; d < n; ++d)
    column[d] = static_cast<std::int16_t>(column[d] + std::abs(a - in[d]) - std::abs(b - out[d]));
}

// Disparity of minimum cost for column u, the smallest one if several are equal.
void winners(const BlockRow& r, int u) {
  const std::int16_t *begin = r.window, *end = begin + r.disparities;
  const auto best = std::min_element(begin, end);
  const int d = static_cast<int>(best - begin), min_cost = *best;
  const int limit = doubt(min_cost, r.doubt_share);
  const auto near = std::count_if(begin, end, [limit](std::int16_t c) { return c <= limit; });
  const RowWinners& to = r.winners;
  to.disparity[u] = static_cast<std::int16_t>(d);
  to.cost[u] = static_cast<std::int16_t>(min_cost);
  to.before[u] = begin[d - 1];
  to.after[u] = begin[d + 1];
  to.in_doubt[u] = static_cast<std::int16_t>(near);
  claim(r, u, d, min_cost);
}

// Block cost C(u, d) as a running sum of 2 half + 1 column sums, and its winners; see match_row().
void plain_row(const BlockRow& r) {
  const int n = r.disparities, block = 2 * r.half + 1;
  std::fill(r.window, r.window + n, std::int16_t{0});
  for (int u = 0; u < r.width; ++u) {
    move_column(r, u);
    if (!r.full) continue;
    const std::int16_t* in = r.columns + static_cast<std::ptrdiff_t>(u) * n;
    for (int d = 0; d < n; ++d) {
      const int out = u < block ? 0 : in[d - block * n];
      r.window[d] = static_cast<std::int16_t>(r.window[d] + in[d] - out);
    }
    if (u + 1 >= block && r.wanted[u - r.half] != 0) winners(r, u - r.half);
  }
}

[[gnu::always_inline]] inline bool near_plane(const float* __restrict disparity,
                                              const std::uint8_t* __restrict textured, int width,
                                              float start, float slope,
                                              std::uint8_t* __restrict wanted) {
  int any = 0;
  for (int u = 0; u < width; ++u) {
    const float d = disparity[u], off = std::abs(d - (start + slope * static_cast<float>(u)));
    wanted[u] = static_cast<std::uint8_t>((((d == 0) | (off < kNear_px)) ? 1 : 0) & textured[u]);
    any |= wanted[u];
  }
  return any != 0;
}
#ifdef KAZ_DEPTH_AVX2
KAZ_AVX2 bool near_plane_avx2(const float* disparity, const std::uint8_t* textured, int width,
                              float start, float slope, std::uint8_t* wanted) {
  return near_plane(disparity, textured, width, start, slope, wanted);
}
#endif

}  // namespace

void match_row(const BlockRow& r, bool vectors) {
  if (r.full) std::fill(r.claims, r.claims + r.width + r.disparities, UINT32_MAX);
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) return match_row_avx2(r);
#endif
  (void)vectors;
  plain_row(r);
}

void take_row(const MatchedRow& r, float* disparity, std::int16_t* cost, bool vectors) {
  std::fill(disparity, disparity + r.half, 0.0F);
  std::fill(disparity + r.width - r.half, disparity + r.width, 0.0F);
  int u = r.half;
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) u = take_row_avx2(r, disparity, cost);
#endif
  (void)vectors;
  for (; u < r.width - r.half; ++u) {
    float d = 0;
    const bool good = judge(r, u, d) && d <= static_cast<float>(u - r.half);
    disparity[u] = good ? d : 0;
    cost[u] = r.winners.cost[u];
  }
}

bool near_row(const DisparityPlane& plane, int v, const float* disparity,
              const std::uint8_t* textured, int width, std::uint8_t* wanted, bool vectors) {
  const float start = plane.at(0, static_cast<float>(v));
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2())
    return near_plane_avx2(disparity, textured, width, start, plane.a, wanted);
#endif
  (void)vectors;
  return near_plane(disparity, textured, width, start, plane.a, wanted);
}

void take_slanted_row(const MatchedRow& r, const DisparityPlane& plane, int v, float* disparity,
                      std::int16_t* cost, bool vectors) {
  constexpr float kMiddle = kAround / 2;
  int u = r.half;
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) u = take_slanted_row_avx2(r, plane, v, disparity, cost);
#endif
  (void)vectors;
  for (; u < r.width - r.half; ++u) {
    float away = 0;
    if (!judge(r, u, away) || std::abs(away - kMiddle) > kOn_px ||
        100 * r.winners.cost[u] > kMaxCost_percent * cost[u])
      continue;
    const float moved = plane.at(static_cast<float>(u) - away, static_cast<float>(v));
    const float d = away + moved - kMiddle;
    if (d <= 0 || d > static_cast<float>(u - r.half)) continue;
    disparity[u] = d;
    cost[u] = std::min(r.winners.cost[u], cost[u]);
  }
}

}  // namespace kaz::vision
