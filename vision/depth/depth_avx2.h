// AVX2 support for block matching: detects AVX2, loads vectors and stores vectors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_DEPTH_AVX2

#include <immintrin.h>

#define KAZ_AVX2 [[gnu::target("avx2,popcnt,bmi")]]
#define KAZ_AVX2_INLINE [[gnu::target("avx2,popcnt,bmi"), gnu::always_inline]] inline

namespace kaz::vision {

// True if the processor has AVX2, POPCNT and BMI.
inline bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0 &&
                          __builtin_cpu_supports("popcnt") != 0 &&
                          __builtin_cpu_supports("bmi") != 0;
  return has;
}

template <class T>
KAZ_AVX2_INLINE __m256i load(const T* from) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}
template <class T>
KAZ_AVX2_INLINE void store(T* to, __m256i x) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), x);
}

}  // namespace kaz::vision

#endif
