// Block matching of a row with AVX2: 16 disparities of 16 bits at a time.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_rows.h"

#ifdef KAZ_DEPTH_AVX2

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cstddef>

#define KAZ_AVX2 [[gnu::target("avx2,popcnt")]]
#define KAZ_AVX2_INLINE [[gnu::target("avx2,popcnt"), gnu::always_inline]] inline

namespace kaz::vision {
namespace {

constexpr int kLanes = 16;

KAZ_AVX2_INLINE __m256i load(const std::int16_t* from) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}
KAZ_AVX2_INLINE void store(std::int16_t* to, __m256i x) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), x);
}
KAZ_AVX2_INLINE __m256i wide(const std::uint8_t* from) {
  return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
}
// Minimum of sixteen non-negative values, in the lowest of eight lanes.
KAZ_AVX2_INLINE __m128i min_of(__m256i x) {
  const __m128i half = _mm_min_epu16(_mm256_castsi256_si128(x), _mm256_extracti128_si256(x, 1));
  return _mm_minpos_epu16(half);
}
// doubt() of depth_rows.h for sixteen costs.
KAZ_AVX2_INLINE __m256i doubt_of(__m256i min_cost, int share) {
  const __m256i more =
      _mm256_mulhi_epu16(min_cost, _mm256_set1_epi16(static_cast<std::int16_t>(share)));
  return _mm256_min_epi16(_mm256_adds_epi16(min_cost, more), _mm256_set1_epi16(INT16_MAX - 1));
}

// Number of costs up to `limit`.
template <int B>
KAZ_AVX2_INLINE int in_doubt(const std::int16_t* window, int blocks, __m256i limit) {
  const int count = B > 0 ? B : blocks;
  int found = 0;
#pragma GCC unroll 4
  for (int b = 0; b < count; b += 2) {
    const __m256i one = _mm256_cmpgt_epi16(load(window + b * kLanes), limit);
    const __m256i two = b + 1 < count ? _mm256_cmpgt_epi16(load(window + (b + 1) * kLanes), limit)
                                      : _mm256_set1_epi16(-1);
    const auto mask = static_cast<unsigned>(_mm256_movemask_epi8(_mm256_packs_epi16(one, two)));
    found += 32 - std::popcount(mask);
  }
  return found;
}

// Per lane the minimum cost and its disparity.
struct Minimum {
  __m256i cost, disparity;
};

// Updates the sums of column u by the entering and the leaving row. If `full`, adds the column to the window
// and updates the minima; if `leaves`, also subtracts the column that leaves the window.
template <int B, bool full, bool leaves>
KAZ_AVX2_INLINE void move(const BlockRow& r, int u, int blocks, Minimum& best) {
  const int count = B > 0 ? B : blocks, n = count * kLanes;
  const auto at = static_cast<std::ptrdiff_t>(r.width - 1 - u);
  const std::uint8_t *in = r.right + at, *gone = r.right_gone + at;
  std::int16_t* column = r.columns + static_cast<std::ptrdiff_t>(u) * n;
  const std::int16_t* old = column - static_cast<std::ptrdiff_t>(2 * r.half + 1) * n;
  std::int16_t* window = r.window;
  const __m256i left = _mm256_set1_epi16(r.left[u]), left_gone = _mm256_set1_epi16(r.left_gone[u]);
  __m256i index = _mm256_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  best = {_mm256_set1_epi16(INT16_MAX), index};
#pragma GCC unroll 8
  for (int b = 0; b < count; ++b) {
    const __m256i p = _mm256_abs_epi16(_mm256_sub_epi16(left, wide(in + b * kLanes)));
    const __m256i q = _mm256_abs_epi16(_mm256_sub_epi16(left_gone, wide(gone + b * kLanes)));
    const __m256i sum = _mm256_add_epi16(load(column + b * kLanes), _mm256_sub_epi16(p, q));
    store(column + b * kLanes, sum);
    if (!full) continue;
    __m256i w = _mm256_add_epi16(load(window + b * kLanes), sum);
    if (leaves) w = _mm256_sub_epi16(w, load(old + b * kLanes));
    store(window + b * kLanes, w);
    const __m256i better = _mm256_cmpgt_epi16(best.cost, w);
    best.cost = _mm256_min_epi16(best.cost, w);
    best.disparity = _mm256_blendv_epi8(best.disparity, index, better);
    index = _mm256_add_epi16(index, _mm256_set1_epi16(kLanes));
  }
}

// Minimum over the lanes; of equal costs the smallest disparity, as std::min_element in depth_rows.cpp.
template <int B>
KAZ_AVX2_INLINE void decide(const BlockRow& r, int u, int blocks, const Minimum& best) {
  const __m128i min_cost = min_of(best.cost);
  const __m256i all = _mm256_broadcastw_epi16(min_cost);
  const __m256i loses = _mm256_cmpgt_epi16(best.cost, all);
  const __m128i d = min_of(_mm256_or_si256(best.disparity, loses));
  put_winner(r, u, _mm_extract_epi16(d, 0), _mm_extract_epi16(min_cost, 0),
             in_doubt<B>(r.window, blocks, doubt_of(all, r.doubt_share)));
}

template <int B>  // blocks of sixteen disparities, so that the compiler unrolls; 0: any number
KAZ_AVX2_INLINE void match(const BlockRow& row) {
  const BlockRow r = row;
  const int blocks = r.disparities / kLanes, block = 2 * r.half + 1;
  Minimum best{_mm256_setzero_si256(), _mm256_setzero_si256()};
  if (r.winners == nullptr) {
    for (int u = 0; u < r.width; ++u) move<B, false, false>(r, u, blocks, best);
    return;
  }
  std::fill(r.window, r.window + blocks * kLanes, std::int16_t{0});
  for (int u = 0; u < block; ++u) move<B, true, false>(r, u, blocks, best);
  if (r.wanted[r.half] != 0) decide<B>(r, r.half, blocks, best);
  for (int u = block; u < r.width; ++u) {
    move<B, true, true>(r, u, blocks, best);
    if (r.wanted[u - r.half] != 0) decide<B>(r, u - r.half, blocks, best);
  }
}

}  // namespace

KAZ_AVX2 void match_row_avx2(const BlockRow& row) {
  switch (row.disparities / kLanes) {
    case 1:
      return match<1>(row);
    case 2:
      return match<2>(row);
    case 3:
      return match<3>(row);
    case 4:
      return match<4>(row);
    case 5:
      return match<5>(row);
    case 6:
      return match<6>(row);
    case 7:
      return match<7>(row);
    case 8:
      return match<8>(row);
    default:
      return match<0>(row);
  }
}

}  // namespace kaz::vision

#endif
