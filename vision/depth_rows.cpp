// Whole numbers only, but for where a match lies between pixels: rounded alike with any vectors.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth_rows.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace kaz::vision {
namespace {

void move_column(const BlockRow& r, int u) {
  const int n = r.disparities;
  const auto at = static_cast<std::ptrdiff_t>(r.width - 1 - u);
  const std::uint8_t *in = r.right + at, *out = r.right_gone + at;
  std::int16_t* column = r.columns + static_cast<std::ptrdiff_t>(u) * n;
  const int a = r.left[u], b = r.left_gone[u];
  for (int d = 0; d < n; ++d)
    column[d] = static_cast<std::int16_t>(column[d] + std::abs(a - in[d]) - std::abs(b - out[d]));
}

void winners(const BlockRow& r, int u) {
  const std::int16_t *begin = r.window, *end = begin + r.disparities;
  const auto best = std::min_element(begin, end);
  const int d = static_cast<int>(best - begin), least = *best;
  const int limit = doubt(least, r.doubt_share);
  const auto near = std::count_if(begin, end, [limit](std::int16_t c) { return c <= limit; });
  put_winner(r, u, d, least, static_cast<int>(near));
}

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

#ifdef KAZ_DEPTH_AVX2
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

void filter_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                int width, std::uint8_t* to) {
#ifdef KAZ_DEPTH_AVX2
  if (has_avx2()) return filter_avx2(above, here, below, width, to);
#endif
  filter(above, here, below, width, to);
}

}  // namespace kaz::vision
