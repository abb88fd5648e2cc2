// Integer arithmetic except for the subpixel disparity, one division, which SIMD rounds in the same way.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_rows.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

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
  put_winner(r, u, d, min_cost, static_cast<int>(near));
}

// Block cost C(u, d) as a running sum of 2 half + 1 column sums, and its winners; see match_row().
void plain_row(const BlockRow& r) {
  const int n = r.disparities, block = 2 * r.half + 1;
  std::fill(r.window, r.window + n, std::int16_t{0});
  for (int u = 0; u < r.width; ++u) {
    move_column(r, u);
    if (r.winners == nullptr) continue;
    const std::int16_t* in = r.columns + static_cast<std::ptrdiff_t>(u) * n;
    for (int d = 0; d < n; ++d) {
      const int out = u < block ? 0 : in[d - block * n];
      r.window[d] = static_cast<std::int16_t>(r.window[d] + in[d] - out);
    }
    if (u + 1 >= block && r.wanted[u - r.half] != 0) winners(r, u - r.half);
  }
}

[[gnu::always_inline]] inline void filter(const std::uint8_t* __restrict above,
                                          const std::uint8_t* __restrict here,
                                          const std::uint8_t* __restrict below, int width,
                                          std::uint8_t* __restrict to) {
  const auto at = [&](int l, int r) {
    const int change = (above[r] - above[l]) + 2 * (here[r] - here[l]) + (below[r] - below[l]);
    const auto c = static_cast<std::int16_t>(change);
    const std::int16_t low = c < -kFilterCap ? -kFilterCap : c;
    return static_cast<std::uint8_t>((low > kFilterCap ? kFilterCap : low) + kFilterCap);
  };
  to[0] = to[width - 1] = kFilterCap;
  for (int u = 1; u + 1 < width; ++u) to[u] = at(u - 1, u + 1);
}

[[gnu::always_inline]] inline void judge(
    const std::int16_t* __restrict winner, const std::int16_t* __restrict min_cost,
    const std::int16_t* __restrict before, const std::int16_t* __restrict after,
    const std::int16_t* __restrict in_doubt, const std::uint8_t* __restrict wanted, int count,
    int disparities, int share, float* __restrict disparity, std::int16_t* __restrict cost,
    std::uint8_t* __restrict good) {
  const int last = disparities - 1;
  for (int u = 0; u < count; ++u) {
    const int d = winner[u], c = min_cost[u], p = before[u], q = after[u];
    const int limit = doubt(c, share);
    const int own = 1 + (p <= limit ? 1 : 0) + (q <= limit ? 1 : 0);
    const int inner = (d > 0 ? 1 : 0) & (d < last ? 1 : 0);
    const int rise = std::max(1, 2 * (std::max(p, q) - c));
    const int shift = inner != 0 ? p - q : 0;
    disparity[u] = static_cast<float>(d) + static_cast<float>(shift) / static_cast<float>(rise);
    cost[u] = static_cast<std::int16_t>(c);
    good[u] = static_cast<std::uint8_t>(inner & (in_doubt[u] == own ? 1 : 0) & wanted[u]);
  }
}

[[gnu::always_inline]] inline void judge(const RowWinners& w, const std::uint8_t* wanted, int begin,
                                         int end, int disparities, int share,
                                         const RowMatches& to) {
  judge(w.disparity + begin, w.cost + begin, w.before + begin, w.after + begin, w.in_doubt + begin,
        wanted + begin, end - begin, disparities, share, to.disparity + begin, to.cost + begin,
        to.good + begin);
}

#ifdef KAZ_DEPTH_AVX2
[[gnu::target("avx2")]] void judge_avx2(const RowWinners& w, const std::uint8_t* wanted, int begin,
                                        int end, int disparities, int share, const RowMatches& to) {
  judge(w, wanted, begin, end, disparities, share, to);
}
[[gnu::target("avx2")]] void filter_avx2(const std::uint8_t* above, const std::uint8_t* here,
                                         const std::uint8_t* below, int width, std::uint8_t* to) {
  filter(above, here, below, width, to);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

}  // namespace

void match_row(const BlockRow& r, bool vectors) {
  if (r.winners != nullptr) {
    std::fill(r.right_cost, r.right_cost + r.width + r.disparities, INT16_MAX);
    std::fill(r.right_disparity, r.right_disparity + r.width + r.disparities, std::int16_t{-9});
  }
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) return match_row_avx2(r);
#endif
  (void)vectors;
  plain_row(r);
}

void judge_row(const RowWinners& w, const std::uint8_t* wanted, int begin, int end, int disparities,
               int share, const RowMatches& to, bool vectors) {
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) return judge_avx2(w, wanted, begin, end, disparities, share, to);
#endif
  (void)vectors;
  judge(w, wanted, begin, end, disparities, share, to);
}

void filter_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                int width, std::uint8_t* to, bool vectors) {
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) return filter_avx2(above, here, below, width, to);
#endif
  (void)vectors;
  filter(above, here, below, width, to);
}

}  // namespace kaz::vision
