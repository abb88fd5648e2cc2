// Block matching of a row with AVX2: 32 disparities of 8 bits or 16 of 16 bits at a time.
// SPDX-License-Identifier: Apache-2.0
//
// Differences of codes are bytes, their sums have 16 bits. Of 32 bytes the unpacking instructions make one
// vector of the disparities 0..7 and 16..23 and one of 8..15 and 24..31, and _mm256_packs_epi16 makes bytes
// in the right order of them again. Column sums and windows are kept in that order, `BlockRow::place`; an odd
// block of 16 disparities at the end is in its natural order.
#include "vision/depth/depth_rows_avx2.h"

#ifdef KAZ_DEPTH_AVX2

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

namespace kaz::vision {
namespace {

constexpr int kLanes = 16;

KAZ_AVX2_INLINE __m128i load_half(const void* from) {
  return _mm_loadu_si128(static_cast<const __m128i*>(from));
}

// A window's sums: in registers where the number of blocks B is known, so that loops over it are unrolled;
// else in memory.
template <int B>
struct Window {
  __m256i sum[B];

  KAZ_AVX2_INLINE explicit Window(std::int16_t* /*memory*/) { clear(B); }
  KAZ_AVX2_INLINE void clear(int /*blocks*/) {
    for (__m256i& s : sum) s = _mm256_setzero_si256();
  }
  KAZ_AVX2_INLINE __m256i get(int b) const { return sum[b]; }
  KAZ_AVX2_INLINE void set(int b, __m256i x) { sum[b] = x; }
  KAZ_AVX2_INLINE void put(std::int16_t* memory) const {
#pragma GCC unroll 8
    for (int b = 0; b < B; ++b) store(memory + b * kLanes, sum[b]);
  }
};
template <>
struct Window<0> {
  std::int16_t* memory;

  KAZ_AVX2_INLINE explicit Window(std::int16_t* m) : memory(m) {}
  KAZ_AVX2_INLINE void clear(int blocks) {
    std::fill(memory, memory + blocks * kLanes, std::int16_t{0});
  }
  KAZ_AVX2_INLINE __m256i get(int b) const { return load(memory + b * kLanes); }
  KAZ_AVX2_INLINE void set(int b, __m256i x) const { store(memory + b * kLanes, x); }
  KAZ_AVX2_INLINE void put(std::int16_t* /*to*/) const {}
};

// Adds the change of block b of column u. If `full`, the window moves by the column, and by the one that
// leaves it if `leaves`.
template <int B, bool full, bool leaves>
KAZ_AVX2_INLINE void add_block(std::int16_t* column, std::ptrdiff_t back, __m256i change, int b,
                               Window<B>& window, __m256i& lowest) {
  const __m256i sum = _mm256_add_epi16(load(column + b * kLanes), change);
  store(column + b * kLanes, sum);
  if (!full) return;
  __m256i more = sum;
  if (leaves) more = _mm256_sub_epi16(sum, load(column - back + b * kLanes));
  const __m256i w = _mm256_add_epi16(window.get(b), more);
  window.set(b, w);
  lowest = _mm256_min_epi16(lowest, w);
}

// Updates the sums of column u by the entering and the leaving row, and the window; returns the minimum of
// its costs by lane.
template <int B, bool full, bool leaves>
KAZ_AVX2_INLINE __m256i move(const BlockRow& r, int u, int blocks, Window<B>& window) {
  const int count = B > 0 ? B : blocks, n = count * kLanes;
  const auto at = static_cast<std::ptrdiff_t>(r.width - 1 - u);
  const std::uint8_t *in = r.right + at, *gone = r.right_gone + at;
  std::int16_t* column = r.columns + static_cast<std::ptrdiff_t>(u) * n;
  const std::ptrdiff_t back = static_cast<std::ptrdiff_t>(2 * r.half + 1) * n;
  const auto code = static_cast<char>(r.left[u]), code_gone = static_cast<char>(r.left_gone[u]);
  const __m256i left = _mm256_set1_epi8(code), left_gone = _mm256_set1_epi8(code_gone);
  __m256i lowest = _mm256_set1_epi16(INT16_MAX);
#pragma GCC unroll 8
  for (int b = 0; b + 1 < count; b += 2) {
    // Codes are at most 2 kFilterCap = 62, so bytes hold the differences and their change.
    const __m256i p = _mm256_abs_epi8(_mm256_sub_epi8(left, load(in + b * kLanes)));
    const __m256i q = _mm256_abs_epi8(_mm256_sub_epi8(left_gone, load(gone + b * kLanes)));
    const __m256i change = _mm256_sub_epi8(p, q);
    const __m256i sign = _mm256_cmpgt_epi8(_mm256_setzero_si256(), change);
    add_block<B, full, leaves>(column, back, _mm256_unpacklo_epi8(change, sign), b, window, lowest);
    add_block<B, full, leaves>(column, back, _mm256_unpackhi_epi8(change, sign), b + 1, window,
                               lowest);
  }
  if (count % 2 != 0) {
    const int b = count - 1;
    const __m128i p =
        _mm_abs_epi8(_mm_sub_epi8(_mm256_castsi256_si128(left), load_half(in + b * kLanes)));
    const __m128i q =
        _mm_abs_epi8(_mm_sub_epi8(_mm256_castsi256_si128(left_gone), load_half(gone + b * kLanes)));
    add_block<B, full, leaves>(column, back, _mm256_cvtepi8_epi16(_mm_sub_epi8(p, q)), b, window,
                               lowest);
  }
  return lowest;
}

// One bit for each of up to 64 disparities of the blocks from b on where the cost equals `all`, and where it
// is above `limit`.
struct Bits {
  std::uint64_t equal, above;
};
template <int B>
KAZ_AVX2_INLINE Bits compare(const Window<B>& window, int b, int count, __m256i all,
                             __m256i limit) {
  Bits bits{0, 0};
#pragma GCC unroll 2
  for (int k = 0; k < 4; k += 2) {
    if (b + k >= count) break;
    const __m256i x = window.get(b + k);
    const __m256i equal = _mm256_cmpeq_epi16(x, all), above = _mm256_cmpgt_epi16(x, limit);
    std::uint32_t equal_bits = 0, above_bits = 0;
    if (b + k + 1 < count) {
      const __m256i y = window.get(b + k + 1);
      equal_bits = static_cast<std::uint32_t>(
          _mm256_movemask_epi8(_mm256_packs_epi16(equal, _mm256_cmpeq_epi16(y, all))));
      above_bits = static_cast<std::uint32_t>(
          _mm256_movemask_epi8(_mm256_packs_epi16(above, _mm256_cmpgt_epi16(y, limit))));
    } else {
      equal_bits = static_cast<std::uint32_t>(_mm_movemask_epi8(
          _mm_packs_epi16(_mm256_castsi256_si128(equal), _mm256_extracti128_si256(equal, 1))));
      above_bits = static_cast<std::uint32_t>(_mm_movemask_epi8(
          _mm_packs_epi16(_mm256_castsi256_si128(above), _mm256_extracti128_si256(above, 1))));
    }
    bits.equal |= static_cast<std::uint64_t>(equal_bits) << (k * kLanes);
    bits.above |= static_cast<std::uint64_t>(above_bits) << (k * kLanes);
  }
  return bits;
}

// The winner of column u: of equal costs the smallest disparity, as std::min_element in depth_rows.cpp.
template <int B>
KAZ_AVX2_INLINE void decide(const BlockRow& r, int u, int blocks, const Window<B>& window,
                            __m256i lowest) {
  const int count = B > 0 ? B : blocks;
  const __m128i least = _mm_minpos_epu16(
      _mm_min_epu16(_mm256_castsi256_si128(lowest), _mm256_extracti128_si256(lowest, 1)));
  const __m256i all = _mm256_broadcastw_epi16(least);
  // doubt() of depth_rows.h; a sum that saturates is above all costs, as that one is.
  const __m256i share = _mm256_set1_epi16(static_cast<std::int16_t>(r.doubt_share));
  const __m256i limit = _mm256_adds_epi16(all, _mm256_mulhi_epu16(all, share));
  window.put(r.window);
  int d = 0, above = 0;
  for (int b = (count - 1) / 4 * 4; b >= 0; b -= 4) {
    const Bits bits = compare<B>(window, b, count, all, limit);
    const int first = b * kLanes + std::countr_zero(bits.equal);
    d = (B > 0 && B <= 4) || bits.equal != 0 ? first : d;
    above += std::popcount(bits.above);
  }
  const int cost = _mm_cvtsi128_si32(least) & 0xffff;
  r.winners.disparity[u] = static_cast<std::int16_t>(d);
  r.winners.cost[u] = static_cast<std::int16_t>(cost);
  r.winners.before[u] = r.window[r.place[d - 1]];
  r.winners.after[u] = r.window[r.place[d + 1]];
  r.winners.in_doubt[u] = static_cast<std::int16_t>(count * kLanes - above);
  claim(r, u, d, cost);
}

template <int B>  // blocks of sixteen disparities; 0: any number
KAZ_AVX2_INLINE void match(const BlockRow& row) {
  const BlockRow r = row;
  const int blocks = r.disparities / kLanes, block = 2 * r.half + 1;
  Window<B> window(r.window);
  if (!r.full) {
    for (int u = 0; u < r.width; ++u) move<B, false, false>(r, u, blocks, window);
    return;
  }
  window.clear(blocks);
  __m256i lowest = _mm256_setzero_si256();
  for (int u = 0; u < block; ++u) lowest = move<B, true, false>(r, u, blocks, window);
  if (r.wanted[r.half] != 0) decide<B>(r, r.half, blocks, window, lowest);
  for (int u = block; u < r.width; ++u) {
    lowest = move<B, true, true>(r, u, blocks, window);
    if (r.wanted[u - r.half] != 0) decide<B>(r, u - r.half, blocks, window, lowest);
  }
}

// Costs of sixteen columns by disparity: cost[d + 1] of disparity d, INT16_MAX at both ends.
struct Costs {
  __m256i cost[kLanes + 2];
};

// Transposes sixteen windows of sixteen disparities.
KAZ_AVX2_INLINE void transpose(const std::int16_t* windows, Costs& to) {
  to.cost[0] = to.cost[kLanes + 1] = _mm256_set1_epi16(INT16_MAX);
#pragma GCC unroll 2
  for (int side = 0; side < 2; ++side) {  // disparities 0..7, then 8..15
    __m256i x[8], y[8];
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) {
      const std::int16_t* from = windows + i * kLanes + side * 8;
      x[i] = _mm256_inserti128_si256(_mm256_castsi128_si256(load_half(from)),
                                     load_half(from + 8 * kLanes), 1);
    }
#pragma GCC unroll 4
    for (int i = 0; i < 8; i += 2) {
      y[i] = _mm256_unpacklo_epi16(x[i], x[i + 1]);
      y[i + 1] = _mm256_unpackhi_epi16(x[i], x[i + 1]);
    }
#pragma GCC unroll 2
    for (int i = 0; i < 8; i += 4) {
      x[i] = _mm256_unpacklo_epi32(y[i], y[i + 2]);
      x[i + 1] = _mm256_unpackhi_epi32(y[i], y[i + 2]);
      x[i + 2] = _mm256_unpacklo_epi32(y[i + 1], y[i + 3]);
      x[i + 3] = _mm256_unpackhi_epi32(y[i + 1], y[i + 3]);
    }
    __m256i* out = to.cost + 1 + side * 8;
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      out[2 * i] = _mm256_unpacklo_epi64(x[i], x[i + 4]);
      out[2 * i + 1] = _mm256_unpackhi_epi64(x[i], x[i + 4]);
    }
  }
}

// Winners of the sixteen columns from u on, a lane each.
KAZ_AVX2_INLINE void decide_columns(const BlockRow& r, int u) {
  Costs costs;
  transpose(r.windows + static_cast<std::ptrdiff_t>(u) * kLanes, costs);
  const __m256i* cost = costs.cost + 1;
  __m256i least = cost[0], d = _mm256_setzero_si256(), before = cost[-1], after = cost[1];
#pragma GCC unroll 16
  for (int k = 1; k < kLanes; ++k) {
    const __m256i better = _mm256_cmpgt_epi16(least, cost[k]);
    least = _mm256_min_epi16(least, cost[k]);
    d = _mm256_blendv_epi8(d, _mm256_set1_epi16(static_cast<std::int16_t>(k)), better);
    before = _mm256_blendv_epi8(before, cost[k - 1], better);
    after = _mm256_blendv_epi8(after, cost[k + 1], better);
  }
  const __m256i share = _mm256_set1_epi16(static_cast<std::int16_t>(r.doubt_share));
  const __m256i limit = _mm256_adds_epi16(least, _mm256_mulhi_epu16(least, share));
  __m256i in_doubt = _mm256_set1_epi16(kLanes);
#pragma GCC unroll 16
  for (int k = 0; k < kLanes; ++k)
    in_doubt = _mm256_add_epi16(in_doubt, _mm256_cmpgt_epi16(cost[k], limit));
  store(r.winners.disparity + u, d);
  store(r.winners.cost + u, least);
  store(r.winners.before + u, before);
  store(r.winners.after + u, after);
  store(r.winners.in_doubt + u, in_doubt);
}

// move() for sixteen disparities, with the window of the column's block kept.
template <bool full, bool leaves>
KAZ_AVX2_INLINE void move_sixteen(const BlockRow& r, int u, __m256i& window) {
  const auto at = static_cast<std::ptrdiff_t>(r.width - 1 - u);
  const auto code = static_cast<char>(r.left[u]), code_gone = static_cast<char>(r.left_gone[u]);
  const __m128i p = _mm_abs_epi8(_mm_sub_epi8(_mm_set1_epi8(code), load_half(r.right + at)));
  const __m128i q =
      _mm_abs_epi8(_mm_sub_epi8(_mm_set1_epi8(code_gone), load_half(r.right_gone + at)));
  std::int16_t* column = r.columns + static_cast<std::ptrdiff_t>(u) * kLanes;
  const __m256i sum = _mm256_add_epi16(load(column), _mm256_cvtepi8_epi16(_mm_sub_epi8(p, q)));
  store(column, sum);
  if (!full) return;
  __m256i more = sum;
  if (leaves)
    more =
        _mm256_sub_epi16(sum, load(column - static_cast<std::ptrdiff_t>(2 * r.half + 1) * kLanes));
  window = _mm256_add_epi16(window, more);
  if (u >= r.half) store(r.windows + static_cast<std::ptrdiff_t>(u - r.half) * kLanes, window);
}

// claim() of the sixteen columns from u on: cost and disparity are joined by vectors, and a claim that is not
// wanted is higher than any other.
KAZ_AVX2_INLINE void claim_sixteen(const BlockRow& r, int u, __m128i wanted) {
  const __m256i idle = _mm256_cvtepi8_epi16(_mm_cmpeq_epi8(wanted, _mm_setzero_si128()));
  const __m256i cost = _mm256_or_si256(load(r.winners.cost + u), idle);
  const __m256i d = load(r.winners.disparity + u);
  alignas(32) std::uint32_t claims[kLanes];  // of columns 0..3, 8..11, 4..7, 12..15
  store(claims, _mm256_unpacklo_epi16(d, cost));
  store(claims + 8, _mm256_unpackhi_epi16(d, cost));
  std::uint32_t* others = r.claims + (r.width - 1 - u);
#pragma GCC unroll 16
  for (int k = 0; k < kLanes; ++k) {
    const std::uint32_t own = claims[(k & 3) | (k & 8) >> 1 | (k & 4) << 1];
    std::uint32_t& other = others[static_cast<std::ptrdiff_t>(own & 0xffff) - k];
    other = std::min(other, own);
  }
}

// Sixteen disparities: the windows of all columns first, which are few bytes, then the winners of sixteen
// columns at a time.
KAZ_AVX2_INLINE void match_sixteen(const BlockRow& row) {
  const BlockRow r = row;
  const int block = 2 * r.half + 1, end = r.width - r.half;
  __m256i window = _mm256_setzero_si256();
  if (!r.full) {
    for (int u = 0; u < r.width; ++u) move_sixteen<false, false>(r, u, window);
    return;
  }
  for (int u = 0; u < block; ++u) move_sixteen<true, false>(r, u, window);
  for (int u = block; u < r.width; ++u) move_sixteen<true, true>(r, u, window);
  int u = r.half;
  for (; u + kLanes <= end; u += kLanes) {
    const __m128i wanted = load_half(r.wanted + u);
    if (_mm_testz_si128(wanted, wanted) != 0) continue;
    decide_columns(r, u);
    claim_sixteen(r, u, wanted);
  }
  if (u == end) return;
  decide_columns(r, u);
  for (; u < end; ++u) {
    if (r.wanted[u] != 0) claim(r, u, r.winners.disparity[u], r.winners.cost[u]);
  }
}

// judge() of the eight columns from u on; `good` is all ones or 0.
struct Judged {
  __m256 disparity;
  __m256i good, cost;
};
KAZ_AVX2_INLINE __m256i wide(const std::int16_t* from) {
  return _mm256_cvtepi16_epi32(load_half(from));
}
KAZ_AVX2_INLINE Judged judge_eight(const MatchedRow& r, int u) {
  const RowWinners& w = r.winners;
  const __m256i d = wide(w.disparity + u), c = wide(w.cost + u), p = wide(w.before + u),
                q = wide(w.after + u), one = _mm256_set1_epi32(1);
  const __m256i doubt =
      _mm256_srli_epi32(_mm256_mullo_epi32(c, _mm256_set1_epi32(r.doubt_share)), 16);
  const __m256i limit =
      _mm256_min_epi32(_mm256_add_epi32(c, doubt), _mm256_set1_epi32(INT16_MAX - 1));
  // The winner, and its neighbours that are not above the limit.
  const __m256i own = _mm256_add_epi32(
      _mm256_set1_epi32(3),
      _mm256_add_epi32(_mm256_cmpgt_epi32(p, limit), _mm256_cmpgt_epi32(q, limit)));
  const __m256i high = _mm256_sub_epi32(_mm256_max_epi32(p, q), c);
  const __m256i rise = _mm256_max_epi32(one, _mm256_add_epi32(high, high));
  Judged to;
  to.cost = c;
  to.disparity = _mm256_add_ps(
      _mm256_cvtepi32_ps(d),
      _mm256_div_ps(_mm256_cvtepi32_ps(_mm256_sub_epi32(p, q)), _mm256_cvtepi32_ps(rise)));
  const __m256i columns = _mm256_sub_epi32(_mm256_set1_epi32(r.width - 1 - u),
                                           _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  const __m256i claims = _mm256_i32gather_epi32(reinterpret_cast<const int*>(r.claims),
                                                _mm256_add_epi32(columns, d), 4);
  const __m256i other = _mm256_and_si256(claims, _mm256_set1_epi32(0xffff));
  const __m256i off = _mm256_abs_epi32(_mm256_sub_epi32(other, d));
  const __m256i wanted =
      _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(r.wanted + u)));
  const __m256i inner =
      _mm256_and_si256(_mm256_cmpgt_epi32(d, _mm256_setzero_si256()),
                       _mm256_cmpgt_epi32(_mm256_set1_epi32(r.disparities - 1), d));
  const __m256i unique = _mm256_cmpeq_epi32(wide(w.in_doubt + u), own);
  const __m256i good = _mm256_and_si256(_mm256_and_si256(inner, unique),
                                        _mm256_cmpgt_epi32(wanted, _mm256_setzero_si256()));
  to.good = _mm256_andnot_si256(_mm256_cmpgt_epi32(off, _mm256_set1_epi32(r.left_right_px)), good);
  return to;
}

KAZ_AVX2_INLINE __m256 numbers_from(int first) {
  return _mm256_cvtepi32_ps(
      _mm256_add_epi32(_mm256_set1_epi32(first), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)));
}

}  // namespace

KAZ_AVX2 int take_row_avx2(const MatchedRow& row, float* disparity, std::int16_t* cost) {
  const MatchedRow r = row;
  int u = r.half;
  for (; u + 8 <= r.width - r.half; u += 8) {
    const Judged j = judge_eight(r, u);
    const __m256 seen = _mm256_cmp_ps(j.disparity, numbers_from(u - r.half), _CMP_LE_OQ);
    const __m256 good = _mm256_and_ps(seen, _mm256_castsi256_ps(j.good));
    _mm256_storeu_ps(disparity + u, _mm256_and_ps(good, j.disparity));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(cost + u), load_half(r.winners.cost + u));
  }
  return u;
}

KAZ_AVX2 int take_slanted_row_avx2(const MatchedRow& row, const DisparityPlane& plane, int v,
                                   float* disparity, std::int16_t* cost) {
  const MatchedRow r = row;
  const __m256 middle = _mm256_set1_ps(kAround / 2), zero = _mm256_setzero_ps();
  const __m256 slope = _mm256_set1_ps(plane.a), offset = _mm256_set1_ps(plane.c);
  const __m256 down = _mm256_set1_ps(plane.b * static_cast<float>(v));
  const __m256 sign = _mm256_set1_ps(-0.0F);
  int u = r.half;
  for (; u + 8 <= r.width - r.half; u += 8) {
    std::uint64_t wanted = 0;
    std::memcpy(&wanted, r.wanted + u, sizeof wanted);
    if (wanted == 0) continue;
    const Judged j = judge_eight(r, u);
    const __m256 off = _mm256_andnot_ps(sign, _mm256_sub_ps(j.disparity, middle));
    const __m256i old = wide(cost + u);
    const __m256i dear =
        _mm256_cmpgt_epi32(_mm256_mullo_epi32(j.cost, _mm256_set1_epi32(100)),
                           _mm256_mullo_epi32(old, _mm256_set1_epi32(kMaxCost_percent)));
    const __m256 column = _mm256_sub_ps(numbers_from(u), j.disparity);
    const __m256 moved = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(slope, column), down), offset);
    const __m256 d = _mm256_sub_ps(_mm256_add_ps(j.disparity, moved), middle);
    const __m256 seen = _mm256_and_ps(_mm256_cmp_ps(d, zero, _CMP_GT_OQ),
                                      _mm256_cmp_ps(d, numbers_from(u - r.half), _CMP_LE_OQ));
    const __m256 on = _mm256_cmp_ps(off, _mm256_set1_ps(kOn_px), _CMP_LE_OQ);
    const __m256i good = _mm256_andnot_si256(
        dear, _mm256_and_si256(j.good, _mm256_castps_si256(_mm256_and_ps(on, seen))));
    _mm256_storeu_ps(disparity + u, _mm256_blendv_ps(_mm256_loadu_ps(disparity + u), d,
                                                     _mm256_castsi256_ps(good)));
    const __m256i best = _mm256_blendv_epi8(old, _mm256_min_epi32(old, j.cost), good);
    _mm_storeu_si128(
        reinterpret_cast<__m128i*>(cost + u),
        _mm_packs_epi32(_mm256_castsi256_si128(best), _mm256_extracti128_si256(best, 1)));
  }
  return u;
}

KAZ_AVX2 void match_row_avx2(const BlockRow& row) {
  switch (row.disparities / kLanes) {
    case 1:
      return match_sixteen(row);
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
