// Integer arithmetic only, so that vectors give the same codes.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_filter.h"

#include <algorithm>
#include <cstdlib>

#include "vision/depth/depth_avx2.h"

namespace kaz::vision {
namespace {

// The derivative of the pixels begin .. end - 1, which are not at the row's ends.
void filter(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
            int begin, int end, std::uint8_t* to) {
  for (int u = begin; u < end; ++u) {
    const int l = u - 1, r = u + 1;
    const int change = (above[r] - above[l]) + 2 * (here[r] - here[l]) + (below[r] - below[l]);
    to[u] = static_cast<std::uint8_t>(std::clamp(change, -kFilterCap, kFilterCap) + kFilterCap);
  }
}

// Writes the codes begin .. end - 1 of the row.
void warp(const WarpRow& r, int begin, int end) {
  const std::int64_t last = static_cast<std::int64_t>(r.width - 1) << 16;
  std::int64_t at = r.at + static_cast<std::int64_t>(begin) * r.step;
  for (int k = begin; k < end; ++k, at += r.step) {
    std::uint8_t& to = r.to[r.count - 1 - k];
    if (at < 0 || at >= last) {
      to = kFilterCap;
      continue;
    }
    const std::uint8_t* p = r.from + (at >> 16);
    const int part = static_cast<int>(at & 0xffff) >> 8;
    to = static_cast<std::uint8_t>((p[0] * (256 - part) + p[1] * part + 128) >> 8);
  }
}

void texture(const TextureRow& r) {
  for (int u = 0; u < r.width; ++u)
    r.columns[u] = static_cast<std::int16_t>(r.columns[u] + std::abs(r.in[u] - kFilterCap) -
                                             std::abs(r.gone[u] - kFilterCap));
  if (r.textured == nullptr) return;
  int sum = 0;
  for (int u = 0; u < r.width; ++u) {
    sum += r.columns[u];
    if (u >= r.block) sum -= r.columns[u - r.block];
    if (u + 1 >= r.block) r.textured[u - r.block / 2] = sum >= r.min_sum ? 1 : 0;
  }
}

#ifdef KAZ_DEPTH_AVX2
KAZ_AVX2_INLINE __m256i wide(const std::uint8_t* from) {
  return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
}
// Weighted sums of three rows.
KAZ_AVX2_INLINE __m256i column_sums(const std::uint8_t* above, const std::uint8_t* here,
                                    const std::uint8_t* below) {
  const __m256i mid = wide(here);
  return _mm256_add_epi16(_mm256_add_epi16(wide(above), wide(below)), _mm256_add_epi16(mid, mid));
}
KAZ_AVX2_INLINE __m256i derivative(const std::uint8_t* above, const std::uint8_t* here,
                                   const std::uint8_t* below) {
  const __m256i cap = _mm256_set1_epi16(kFilterCap);
  const __m256i change = _mm256_sub_epi16(column_sums(above + 1, here + 1, below + 1),
                                          column_sums(above - 1, here - 1, below - 1));
  const __m256i low = _mm256_max_epi16(change, _mm256_sub_epi16(_mm256_setzero_si256(), cap));
  return _mm256_add_epi16(_mm256_min_epi16(low, cap), cap);
}
KAZ_AVX2 void filter_avx2(const std::uint8_t* above, const std::uint8_t* here,
                          const std::uint8_t* below, int width, std::uint8_t* to) {
  int u = 1;
  for (; u + 33 <= width; u += 32) {
    const int v = u + 16;
    const __m256i both = _mm256_packus_epi16(derivative(above + u, here + u, below + u),
                                             derivative(above + v, here + v, below + v));
    store(to + u, _mm256_permute4x64_epi64(both, 0b11'01'10'00));
  }
  filter(above, here, below, u, width - 1, to);
}

KAZ_AVX2 void mirror_avx2(const std::uint8_t* from, int width, std::uint8_t* to) {
  const __m256i reverse = _mm256_broadcastsi128_si256(
      _mm_setr_epi8(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0));
  int u = 0;
  for (; u + 32 <= width; u += 32) {
    const __m256i lanes = _mm256_shuffle_epi8(load(from + width - 32 - u), reverse);
    store(to + u, _mm256_permute4x64_epi64(lanes, 0b01'00'11'10));
  }
  for (; u < width; ++u) to[u] = from[width - 1 - u];
}

// Eight neighbouring positions are within 16 bytes of the row, because a step is at most one and a half.
constexpr int kLargestStep = 3 << 15;

KAZ_AVX2 void warp_avx2(const WarpRow& r) {
  const std::int64_t last = static_cast<std::int64_t>(r.width - 1) << 16, step = r.step;
  // The positions begin .. end - 1 are inside of the row.
  const auto first_from = [&](std::int64_t bound) {
    return static_cast<int>(std::clamp<std::int64_t>((bound - r.at + step - 1) / step, 0, r.count));
  };
  const int begin = r.at < 0 ? first_from(0) : 0, end = r.at < last ? first_from(last) : 0;
  warp(r, 0, begin);
  const __m256i steps =
      _mm256_mullo_epi32(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), _mm256_set1_epi32(r.step));
  // The low bytes of eight numbers of 16 bits, from the last to the first.
  const __m128i pick = _mm_setr_epi8(14, 12, 10, 8, 6, 4, 2, 0, -1, -1, -1, -1, -1, -1, -1, -1);
  int k = begin;
  for (; k + 8 <= end; k += 8) {
    const std::int64_t at = r.at + k * step;
    const __m256i positions =
        _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(at & 0xffff)), steps);
    const __m256i whole = _mm256_srli_epi32(positions, 16);
    const __m256i part = _mm256_and_si256(_mm256_srli_epi32(positions, 8), _mm256_set1_epi32(0xff));
    const __m256i both = _mm256_permute4x64_epi64(_mm256_packus_epi32(whole, part), 0b11'01'10'00);
    const __m128i index = _mm256_castsi256_si128(both), share = _mm256_extracti128_si256(both, 1);
    // p and its right neighbour r as two bytes; p (256 - s) + r s + 128 = 256 p + (r - p) s + 128.
    const __m128i pairs =
        _mm_add_epi16(_mm_mullo_epi16(index, _mm_set1_epi16(0x0101)), _mm_set1_epi16(0x0100));
    const __m128i codes = _mm_shuffle_epi8(
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(r.from + (at >> 16))), pairs);
    const __m128i rise = _mm_maddubs_epi16(codes, _mm_set1_epi16(0x01ff));
    const __m128i more =
        _mm_srai_epi16(_mm_add_epi16(_mm_mullo_epi16(rise, share), _mm_set1_epi16(128)), 8);
    const __m128i result = _mm_add_epi16(_mm_and_si128(codes, _mm_set1_epi16(0xff)), more);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(r.to + r.count - 8 - k),
                     _mm_shuffle_epi8(result, pick));
  }
  warp(r, k, r.count);
}

KAZ_AVX2_INLINE __m128i absolute(const std::uint8_t* codes) {
  const __m128i x = _mm_loadu_si128(reinterpret_cast<const __m128i*>(codes));
  return _mm_abs_epi8(_mm_sub_epi8(x, _mm_set1_epi8(kFilterCap)));
}
KAZ_AVX2 void texture_avx2(const TextureRow& r) {
  int u = 0;
  for (; u + 16 <= r.width; u += 16) {
    const __m256i more =
        _mm256_cvtepi8_epi16(_mm_sub_epi8(absolute(r.in + u), absolute(r.gone + u)));
    store(r.columns + u, _mm256_add_epi16(load(r.columns + u), more));
  }
  for (; u < r.width; ++u)
    r.columns[u] = static_cast<std::int16_t>(r.columns[u] + std::abs(r.in[u] - kFilterCap) -
                                             std::abs(r.gone[u] - kFilterCap));
  if (r.textured == nullptr) return;
  // A block's sum is at most 21 x 21 x 31.
  const __m256i below =
      _mm256_set1_epi16(static_cast<std::int16_t>(std::min(r.min_sum, INT16_MAX) - 1));
  const int count = r.width - r.block + 1;
  std::uint8_t* to = r.textured + r.block / 2;
  u = 0;
  for (; u + 16 <= count; u += 16) {
    __m256i sum = load(r.columns + u);
    for (int k = 1; k < r.block; ++k) sum = _mm256_add_epi16(sum, load(r.columns + u + k));
    const __m256i is = _mm256_srli_epi16(_mm256_cmpgt_epi16(sum, below), 15);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + u),
                     _mm_packus_epi16(_mm256_castsi256_si128(is), _mm256_extracti128_si256(is, 1)));
  }
  for (; u < count; ++u) {
    int sum = 0;
    for (int k = 0; k < r.block; ++k) sum += r.columns[u + k];
    to[u] = sum >= r.min_sum ? 1 : 0;
  }
}
#endif

}  // namespace

void filter_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                int width, std::uint8_t* to, bool vectors) {
  to[0] = to[width - 1] = kFilterCap;
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) return filter_avx2(above, here, below, width, to);
#endif
  (void)vectors;
  filter(above, here, below, 1, width - 1, to);
}

void mirror_row(const std::uint8_t* from, int width, std::uint8_t* to, bool vectors) {
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) return mirror_avx2(from, width, to);
#endif
  (void)vectors;
  std::reverse_copy(from, from + width, to);
}

void warp_row(const WarpRow& row, bool vectors) {
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2() && row.step > 0 && row.step <= kLargestStep) return warp_avx2(row);
#endif
  (void)vectors;
  warp(row, 0, row.count);
}

void texture_row(const TextureRow& row, bool vectors) {
#ifdef KAZ_DEPTH_AVX2
  if (vectors && has_avx2()) return texture_avx2(row);
#endif
  (void)vectors;
  texture(row);
}

}  // namespace kaz::vision
