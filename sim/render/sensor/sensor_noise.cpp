// Image sensor noise, with sixteen independent random sequences: a vector of them, or one after the other.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/sensor/sensor_noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/base/random.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace kaz::sim {
namespace {

constexpr std::size_t kLanes = 16;
constexpr int kMeanOfBytes = 510;  // of the sum of four random bytes

std::array<std::uint32_t, kLanes> seeds(std::uint64_t key) {
  std::array<std::uint32_t, kLanes> state{};
  for (std::size_t i = 0; i < kLanes; ++i)
    state[i] = static_cast<std::uint32_t>(mix64(key + i) >> 32) | 1U;  // zero would stay zero
  return state;
}

// 32-bit xorshift (Marsaglia, J. Stat. Software 8(14), 2003).
std::uint32_t next(std::uint32_t s) {
  s ^= s << 13;
  s ^= s >> 17;
  return s ^ s << 5;
}

// code' = sqrt(max(0, c^2 + z sqrt(shot c^2 + read))) + 0.5, truncated to 0..255. Single-precision IEEE
// operations without contraction, so that all vector widths round alike.
std::uint8_t exposed(std::uint16_t code64, std::uint32_t random, const NoiseRow::Factors& factors) {
  const std::uint32_t pairs = (random & 0x00FF00FFU) + ((random >> 8) & 0x00FF00FFU);
  const auto z =
      static_cast<float>(static_cast<int>((pairs & 0xFFFFU) + (pairs >> 16)) - kMeanOfBytes);
  const float code = static_cast<float>(code64) * factors.code;
  const float square = code * code;
  const float counted = square + z * std::sqrt(factors.shot * square + factors.read);
  const float noisy = std::sqrt(counted > 0.0F ? counted : 0.0F) + 0.5F;
  return static_cast<std::uint8_t>(static_cast<int>(noisy < 255.0F ? noisy : 255.0F));
}

#if defined(__x86_64__)
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i next(__m256i s) {
  s = _mm256_xor_si256(s, _mm256_slli_epi32(s, 13));
  s = _mm256_xor_si256(s, _mm256_srli_epi32(s, 17));
  return _mm256_xor_si256(s, _mm256_slli_epi32(s, 5));
}

// exposed() for eight values.
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i exposed(
    __m128i codes64, __m256i random, const NoiseRow::Factors& factors) {
  const __m256i pairs = _mm256_maddubs_epi16(random, _mm256_set1_epi8(1));
  const __m256i bytes = _mm256_madd_epi16(pairs, _mm256_set1_epi16(1));
  const __m256 z = _mm256_cvtepi32_ps(_mm256_sub_epi32(bytes, _mm256_set1_epi32(kMeanOfBytes)));
  const __m256 code = _mm256_mul_ps(_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(codes64)),
                                    _mm256_set1_ps(factors.code));
  const __m256 square = _mm256_mul_ps(code, code);
  const __m256 variance = _mm256_add_ps(_mm256_mul_ps(_mm256_set1_ps(factors.shot), square),
                                        _mm256_set1_ps(factors.read));
  const __m256 counted = _mm256_add_ps(square, _mm256_mul_ps(z, _mm256_sqrt_ps(variance)));
  const __m256 noisy = _mm256_add_ps(_mm256_sqrt_ps(_mm256_max_ps(counted, _mm256_setzero_ps())),
                                     _mm256_set1_ps(0.5F));
  return _mm256_cvttps_epi32(_mm256_min_ps(noisy, _mm256_set1_ps(255.0F)));
}

[[gnu::target("avx2")]] void expose_avx2(const std::uint16_t* codes64, std::uint8_t* codes,
                                         NoiseRow::Range range, std::uint64_t key,
                                         const NoiseRow::Factors& factors) {
  const auto state = seeds(key);
  const auto load = [](const void* from) {
    return _mm_loadu_si128(static_cast<const __m128i*>(from));
  };
  const auto store = [](void* to, __m128i v) { _mm_storeu_si128(static_cast<__m128i*>(to), v); };
  __m256i low = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(state.data()));
  __m256i high = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(state.data() + 8));
  std::size_t at = 0;
  for (; at + kLanes <= range.first; at += kLanes) {
    low = next(low);
    high = next(high);
  }
  for (; at < range.end; at += kLanes) {
    low = next(low);
    high = next(high);
    const bool whole = at >= range.first && at + kLanes <= range.end;
    std::array<std::uint16_t, kLanes> part{};
    const std::size_t from = std::max(at, range.first), to = std::min(at + kLanes, range.end);
    if (!whole) std::copy(codes64 + from, codes64 + to, part.data() + (from - at));
    const std::uint16_t* values = whole ? codes64 + at : part.data();
    const __m256i words = _mm256_packus_epi32(exposed(load(values), low, factors),
                                              exposed(load(values + 8), high, factors));
    // Four values of `low`, four of `high`, the other four of each.
    const __m256i ordered = _mm256_permute4x64_epi64(words, 0xD8);
    const __m128i bytes =
        _mm_packus_epi16(_mm256_castsi256_si128(ordered), _mm256_extracti128_si256(ordered, 1));
    if (whole) {
      store(codes + at, bytes);
      continue;
    }
    std::array<std::uint8_t, kLanes> out{};
    store(out.data(), bytes);
    std::copy(out.data() + (from - at), out.data() + (to - at), codes + from);
  }
}

#define KAZ_AVX512 [[gnu::target("avx512bw,avx512dq,avx512vl")]]

// Forms with a mask, as those without make GCC 12 warn of its own headers.
constexpr __mmask16 kAll = 0xffff;

KAZ_AVX512 inline __m512i next_sixteen(__m512i s) {
  s = _mm512_xor_si512(s, _mm512_maskz_slli_epi32(kAll, s, 13));
  s = _mm512_xor_si512(s, _mm512_maskz_srli_epi32(kAll, s, 17));
  return _mm512_xor_si512(s, _mm512_maskz_slli_epi32(kAll, s, 5));
}

// exposed() for sixteen values.
KAZ_AVX512 inline __m128i exposed_sixteen(__m256i codes64, __m512i random,
                                          const NoiseRow::Factors& factors) {
  const __m512i pairs = _mm512_maddubs_epi16(random, _mm512_set1_epi8(1));
  const __m512i bytes = _mm512_madd_epi16(pairs, _mm512_set1_epi16(1));
  const __m512 z =
      _mm512_maskz_cvtepi32_ps(kAll, _mm512_sub_epi32(bytes, _mm512_set1_epi32(kMeanOfBytes)));
  const __m512 code =
      _mm512_mul_ps(_mm512_maskz_cvtepi32_ps(kAll, _mm512_maskz_cvtepu16_epi32(kAll, codes64)),
                    _mm512_set1_ps(factors.code));
  const __m512 square = _mm512_mul_ps(code, code);
  const __m512 variance = _mm512_add_ps(_mm512_mul_ps(_mm512_set1_ps(factors.shot), square),
                                        _mm512_set1_ps(factors.read));
  const __m512 counted =
      _mm512_add_ps(square, _mm512_mul_ps(z, _mm512_maskz_sqrt_ps(kAll, variance)));
  const __m512 noisy = _mm512_add_ps(
      _mm512_maskz_sqrt_ps(kAll, _mm512_maskz_max_ps(kAll, counted, _mm512_setzero_ps())),
      _mm512_set1_ps(0.5F));
  return _mm512_maskz_cvtepi32_epi8(
      kAll,
      _mm512_maskz_cvttps_epi32(kAll, _mm512_maskz_min_ps(kAll, noisy, _mm512_set1_ps(255.0F))));
}

KAZ_AVX512 void expose_avx512(const std::uint16_t* codes64, std::uint8_t* codes,
                              NoiseRow::Range range, std::uint64_t key,
                              const NoiseRow::Factors& factors) {
  const auto seed = seeds(key);
  __m512i state = _mm512_loadu_si512(seed.data());
  std::size_t at = 0;
  for (; at + kLanes <= range.first; at += kLanes) state = next_sixteen(state);
  for (; at < range.end; at += kLanes) {
    state = next_sixteen(state);
    // Lanes inside of the range.
    const std::size_t from = range.first > at ? range.first - at : 0;
    const std::size_t to = std::min(range.end - at, kLanes);
    const auto inside = static_cast<__mmask16>((0xffffU >> (kLanes - to)) & (0xffffU << from));
    const __m256i values = _mm256_maskz_loadu_epi16(inside, codes64 + at);
    _mm_mask_storeu_epi8(codes + at, inside, exposed_sixteen(values, state, factors));
  }
}
#endif

}  // namespace

NoiseRow::NoiseRow(const NoiseLaw& law) {
  // Light 255^2 is a full well, so one electron is 255^2 / full_well in codes squared.
  const double electron = 255.0 * 255.0 / law.full_well_e;
  // Variance of the sum of four uniform bytes: 4 (256^2 - 1) / 12.
  const double bytes = 4 * (256.0 * 256.0 - 1) / 12;
  factors_.code = static_cast<float>(std::sqrt(law.exposure) / 64);
  factors_.shot = static_cast<float>(electron / bytes);
  factors_.read =
      static_cast<float>(law.read_noise_e * law.read_noise_e * electron * electron / bytes);
}

void NoiseRow::expose_plain(const std::uint16_t* codes64, std::uint8_t* codes, Range range,
                            std::uint64_t key) const {
  auto state = seeds(key);
  for (std::size_t i = 0; i < range.end; ++i) {
    std::uint32_t& random = state[i % kLanes];
    random = next(random);
    if (i >= range.first) codes[i] = exposed(codes64[i], random, factors_);
  }
}

void NoiseRow::expose(const std::uint16_t* codes64, std::uint8_t* codes, Range range,
                      std::uint64_t key, InstructionSet with) const {
#if defined(__x86_64__)
  if (with == InstructionSet::avx512) return expose_avx512(codes64, codes, range, key, factors_);
  if (with == InstructionSet::avx2) return expose_avx2(codes64, codes, range, key, factors_);
#endif
  (void)with;
  expose_plain(codes64, codes, range, key);
}

}  // namespace kaz::sim
