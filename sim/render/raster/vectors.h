// Vectors of floats and integers for one instruction set. Each lane of a vector contains one sample.
// SPDX-License-Identifier: Apache-2.0
//
// kernels_plain.cpp, kernels_avx2.cpp and kernels_avx512.cpp include this file. Each of these files defines
// KAZ_RASTER_SET (the namespace) and KAZ_RASTER_LANES for one instruction set. Each floating-point
// operation on a vector is one correctly rounded IEEE operation. Therefore all instruction sets compute the
// same bits. Functions in the namespace KAZ_RASTER_SET never pass vectors to code outside this namespace.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#else
#include <cmath>
#endif

#ifndef KAZ_RASTER_SET  // defaults, used if a tool parses this file alone
#define KAZ_RASTER_SET plain
#define KAZ_RASTER_LANES 4
#endif

// KAZ_RASTER_BEGIN and KAZ_RASTER_END enclose the code of an instruction set. GCC and Clang may use the set's
// instructions in all functions between the two macros.
#if !defined(__x86_64__) || KAZ_RASTER_LANES == 4
#define KAZ_RASTER_BEGIN
#define KAZ_RASTER_END
#elif defined(__clang__) && KAZ_RASTER_LANES == 8
#define KAZ_RASTER_BEGIN \
  _Pragma("clang attribute push(__attribute__((target(\"avx2\"))), apply_to = function)")
#define KAZ_RASTER_END _Pragma("clang attribute pop")
#elif defined(__clang__)
// clang-format off
#define KAZ_RASTER_BEGIN \
_Pragma("clang attribute push(__attribute__((target(\"avx512bw,avx512dq,avx512vl\"))), apply_to = function)")
// clang-format on
#define KAZ_RASTER_END _Pragma("clang attribute pop")
#elif KAZ_RASTER_LANES == 8
#define KAZ_RASTER_BEGIN _Pragma("GCC push_options") _Pragma("GCC target(\"avx2\")")
#define KAZ_RASTER_END _Pragma("GCC pop_options")
#else
#define KAZ_RASTER_BEGIN      \
  _Pragma("GCC push_options") \
      _Pragma("GCC target(\"avx512bw,avx512dq,avx512vl,prefer-vector-width=512\")")
#define KAZ_RASTER_END _Pragma("GCC pop_options")
#endif

KAZ_RASTER_BEGIN
namespace kaz::sim::raster::KAZ_RASTER_SET {

inline constexpr int kLanes = KAZ_RASTER_LANES;
using Floats = float __attribute__((vector_size(4 * KAZ_RASTER_LANES)));
// Integers, or a mask. Each lane of a mask is 0 or -1.
using Ints = std::int32_t __attribute__((vector_size(4 * KAZ_RASTER_LANES)));

#define KAZ_LANES_INLINE [[gnu::always_inline]] static inline

KAZ_LANES_INLINE Floats splat(float x) {
  return x - Floats{};
}
KAZ_LANES_INLINE Ints splat_int(std::int32_t x) {
  return x - Ints{};
}
KAZ_LANES_INLINE Ints lane_numbers() {
  Ints lanes{};
  for (int i = 0; i < kLanes; ++i) lanes[i] = i;
  return lanes;
}
template <class V, class T>
KAZ_LANES_INLINE V load_as(const T* from) {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
KAZ_LANES_INLINE Floats load(const float* from) {
  return load_as<Floats>(from);
}
KAZ_LANES_INLINE Ints load_ints(const void* from) {
  return load_as<Ints>(from);
}
template <class V>
KAZ_LANES_INLINE void store(void* to, const V& v) {
  std::memcpy(to, &v, sizeof v);
}
KAZ_LANES_INLINE Floats to_float(Ints x) {
  return __builtin_convertvector(x, Floats);
}
// Rounds toward zero.
KAZ_LANES_INLINE Ints to_int(Floats x) {
  return __builtin_convertvector(x, Ints);
}
KAZ_LANES_INLINE Ints bits(Floats x) {
  return (Ints)x;
}
KAZ_LANES_INLINE Floats larger(Floats a, Floats b) {
  return a > b ? a : b;
}
KAZ_LANES_INLINE Floats smaller(Floats a, Floats b) {
  return a < b ? a : b;
}
KAZ_LANES_INLINE Ints larger_int(Ints a, Ints b) {
  return a > b ? a : b;
}
KAZ_LANES_INLINE Ints smaller_int(Ints a, Ints b) {
  return a < b ? a : b;
}
KAZ_LANES_INLINE Floats magnitude(Floats x) {
  return (Floats)(bits(x) & 0x7FFFFFFF);
}
KAZ_LANES_INLINE Floats floor_of(Floats x) {
  const Floats whole = to_float(to_int(x));
  return whole > x ? whole - 1.0F : whole;
}

// Result of gather_three(): for each lane, three consecutive words from memory.
struct ThreeWords {
  Ints first, second, third;
};

// The code uses only the masked forms of the AVX-512 intrinsics, because the unmasked forms cause warnings in
// the headers of GCC 12.
#if defined(__x86_64__) && KAZ_RASTER_LANES == 16
KAZ_LANES_INLINE Floats root(Floats x) {
  return (Floats)_mm512_maskz_sqrt_ps(0xFFFF, (__m512)x);
}
// Returns one bit for each lane of a mask.
KAZ_LANES_INLINE std::uint32_t mask_bits(Ints mask) {
  return _mm512_movepi32_mask((__m512i)mask);
}
// Uses sixteen loads instead of AVX-512's gather instruction. On AMD processors, the gather instruction takes
// twice as long as the loads (in gather_three(), three times as long). On Intel processors, a microcode
// update that prevents data leaks has made the gather instruction slow.
KAZ_LANES_INLINE Ints gather_at(const char* from, Ints index, int scale) {
  std::int32_t at[16];
  store(at, index);
  const auto word = [&](int lane) {
    std::int32_t one;
    std::memcpy(&one, from + std::ptrdiff_t{scale} * at[lane], sizeof one);
    return one;
  };
  const auto eight = [&](int lane) {
    return _mm256_setr_epi32(word(lane), word(lane + 1), word(lane + 2), word(lane + 3),
                             word(lane + 4), word(lane + 5), word(lane + 6), word(lane + 7));
  };
  return (Ints)_mm512_maskz_inserti64x4(0xFF, _mm512_castsi256_si512(eight(0)), eight(8), 1);
}
KAZ_LANES_INLINE Ints gather(const void* from, Ints index) {
  return gather_at(static_cast<const char*>(from), index, 4);
}
KAZ_LANES_INLINE Ints gather_pairs(const std::uint16_t* from, Ints index) {
  return gather_at(reinterpret_cast<const char*>(from), index, 2);
}
// Looks up words in a table of 16 words.
KAZ_LANES_INLINE Ints look_up(const std::int32_t* table, Ints index) {
  return (Ints)_mm512_maskz_permutexvar_epi32(0xFFFF, (__m512i)index, _mm512_loadu_si512(table));
}
// Loads four words for each lane. Then transposes the 4 x 4 words in each quarter of the vector.
KAZ_LANES_INLINE ThreeWords gather_three(const std::uint32_t* from, Ints index) {
  std::int32_t at[16];
  store(at, index);
  const auto four = [&](int lane) {
    const auto words = [&](int of) {
      return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + std::ptrdiff_t{4} * at[of]));
    };
    __m512i all = _mm512_castsi128_si512(words(lane));
    all = _mm512_maskz_inserti32x4(0xFFFF, all, words(lane + 4), 1);
    all = _mm512_maskz_inserti32x4(0xFFFF, all, words(lane + 8), 2);
    return _mm512_maskz_inserti32x4(0xFFFF, all, words(lane + 12), 3);
  };
  const __m512i a = four(0), b = four(1), c = four(2), d = four(3);
  const __m512i upper_ab = _mm512_maskz_unpacklo_epi32(0xFFFF, a, b),
                lower_ab = _mm512_maskz_unpackhi_epi32(0xFFFF, a, b);
  const __m512i upper_cd = _mm512_maskz_unpacklo_epi32(0xFFFF, c, d),
                lower_cd = _mm512_maskz_unpackhi_epi32(0xFFFF, c, d);
  return {(Ints)_mm512_maskz_unpacklo_epi64(0xFF, upper_ab, upper_cd),
          (Ints)_mm512_maskz_unpackhi_epi64(0xFF, upper_ab, upper_cd),
          (Ints)_mm512_maskz_unpacklo_epi64(0xFF, lower_ab, lower_cd)};
}
#elif defined(__x86_64__) && KAZ_RASTER_LANES == 8
KAZ_LANES_INLINE Floats root(Floats x) {
  return (Floats)_mm256_sqrt_ps((__m256)x);
}
KAZ_LANES_INLINE std::uint32_t mask_bits(Ints mask) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)mask));
}
// Uses eight loads instead of AVX2's gather instruction. The comment on the AVX-512 version of this function
// states the reasons.
KAZ_LANES_INLINE Ints gather_at(const char* from, Ints index, int scale) {
  std::int32_t at[8];
  store(at, index);
  const auto word = [&](int lane) {
    std::int32_t one;
    std::memcpy(&one, from + std::ptrdiff_t{scale} * at[lane], sizeof one);
    return one;
  };
  return (Ints)_mm256_setr_epi32(word(0), word(1), word(2), word(3), word(4), word(5), word(6),
                                 word(7));
}
KAZ_LANES_INLINE Ints gather(const void* from, Ints index) {
  return gather_at(static_cast<const char*>(from), index, 4);
}
KAZ_LANES_INLINE Ints gather_pairs(const std::uint16_t* from, Ints index) {
  return gather_at(reinterpret_cast<const char*>(from), index, 2);
}
KAZ_LANES_INLINE Ints look_up(const std::int32_t* table, Ints index) {
  const auto eight = [&](int first) {
    const auto* from = reinterpret_cast<const __m256i*>(table + first);
    return (Ints)_mm256_permutevar8x32_epi32(_mm256_loadu_si256(from), (__m256i)index);
  };
  return index > 7 ? eight(8) : eight(0);
}
// Loads four words for each lane. Then transposes the 4 x 4 words in each half of the vector.
KAZ_LANES_INLINE ThreeWords gather_three(const std::uint32_t* from, Ints index) {
  std::int32_t at[8];
  store(at, index);
  const auto two = [&](int lane) {
    const auto four = [&](int of) {
      return reinterpret_cast<const __m128i*>(from + std::ptrdiff_t{4} * at[of]);
    };
    return _mm256_loadu2_m128i(four(lane + 4), four(lane));
  };
  const __m256i a = two(0), b = two(1), c = two(2), d = two(3);
  const __m256i upper_ab = _mm256_unpacklo_epi32(a, b), lower_ab = _mm256_unpackhi_epi32(a, b);
  const __m256i upper_cd = _mm256_unpacklo_epi32(c, d), lower_cd = _mm256_unpackhi_epi32(c, d);
  return {(Ints)_mm256_unpacklo_epi64(upper_ab, upper_cd),
          (Ints)_mm256_unpackhi_epi64(upper_ab, upper_cd),
          (Ints)_mm256_unpacklo_epi64(lower_ab, lower_cd)};
}
#else
#if defined(__x86_64__)
KAZ_LANES_INLINE Floats root(Floats x) {
  return (Floats)_mm_sqrt_ps((__m128)x);
}
KAZ_LANES_INLINE std::uint32_t mask_bits(Ints mask) {
  return static_cast<std::uint32_t>(_mm_movemask_ps((__m128)mask));
}
#else
KAZ_LANES_INLINE Floats root(Floats x) {
  for (int i = 0; i < kLanes; ++i) x[i] = std::sqrt(x[i]);
  return x;
}
KAZ_LANES_INLINE std::uint32_t mask_bits(Ints mask) {
  std::uint32_t found = 0;
  for (int i = 0; i < kLanes; ++i) found |= (mask[i] != 0 ? 1U : 0U) << i;
  return found;
}
#endif
KAZ_LANES_INLINE Ints gather(const void* from, Ints index) {
  Ints found{};
  for (int i = 0; i < kLanes; ++i) {
    std::int32_t one = 0;
    std::memcpy(&one, static_cast<const char*>(from) + std::ptrdiff_t{4} * index[i], sizeof one);
    found[i] = one;
  }
  return found;
}
KAZ_LANES_INLINE ThreeWords gather_three(const std::uint32_t* from, Ints index) {
  ThreeWords found{};
  for (int i = 0; i < kLanes; ++i) {
    std::int32_t words[3];
    std::memcpy(words, from + std::ptrdiff_t{4} * index[i], sizeof words);
    found.first[i] = words[0];
    found.second[i] = words[1];
    found.third[i] = words[2];
  }
  return found;
}
KAZ_LANES_INLINE Ints look_up(const std::int32_t* table, Ints index) {
  return gather(table, index);
}
// Loads two neighboring 16-bit values into each lane. The first value goes into the lower half of the lane.
KAZ_LANES_INLINE Ints gather_pairs(const std::uint16_t* from, Ints index) {
  Ints found{};
  for (int i = 0; i < kLanes; ++i) {
    found[i] = static_cast<std::int32_t>(from[index[i]] |
                                         static_cast<std::uint32_t>(from[index[i] + 1]) << 16);
  }
  return found;
}
#endif

KAZ_LANES_INLINE bool any(Ints mask) {
  return mask_bits(mask) != 0;
}

}  // namespace kaz::sim::raster::KAZ_RASTER_SET
KAZ_RASTER_END
