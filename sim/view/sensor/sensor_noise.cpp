// Image sensor noise, with sixteen independent random sequences so that compilers vectorise the loops.
// SPDX-License-Identifier: Apache-2.0
#include "sim/view/sensor/sensor_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "shared/base/random.hpp"

namespace kaz::sim {
namespace {

constexpr std::size_t kLanes = 16, kBlock = 480;  // a block fits the L1 cache

// 32-bit xorshift (Marsaglia, J. Stat. Software 8(14), 2003) in lanes; z = sum of the number's four bytes
// minus the mean 510.
[[gnu::always_inline]] inline void deviates(std::uint32_t* state, std::int32_t* z) {
  for (std::size_t at = 0; at < kBlock; at += kLanes) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      std::uint32_t s = state[i];
      s ^= s << 13;
      s ^= s >> 17;
      s ^= s << 5;
      state[i] = s;
      const std::uint32_t pairs = (s & 0x00FF00FFu) + ((s >> 8) & 0x00FF00FFu);
      z[at + i] = static_cast<std::int32_t>((pairs & 0xFFFFu) + (pairs >> 16)) - 510;
    }
  }
}

// code' = sqrt(max(0, c^2 + z sqrt(shot c^2 + read))) + 0.5, truncated to 0..255. Single-precision IEEE
// operations without contraction, so that all vector widths round alike.
[[gnu::always_inline]] inline void expose_row(const std::uint16_t* __restrict codes64,
                                              std::uint8_t* __restrict codes, std::size_t count,
                                              std::uint64_t key, const NoiseRow::Factors& factors) {
  std::uint32_t state[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    state[i] = static_cast<std::uint32_t>(mix64(key + i) >> 32) | 1u;  // zero would stay zero
  }
  const float scale = factors.code, shot = factors.shot, read = factors.read;
  std::int32_t z[kBlock];
  for (std::size_t at = 0; at < count; at += kBlock, codes64 += kBlock, codes += kBlock) {
    deviates(state, z);
    const std::size_t n = std::min(kBlock, count - at);
    for (std::size_t i = 0; i < n; ++i) {
      const float code = static_cast<float>(static_cast<std::int32_t>(codes64[i])) * scale;
      const float square = code * code;
      const float counted = square + static_cast<float>(z[i]) * std::sqrt(shot * square + read);
      const float light = counted > 0.0F ? counted : 0.0F;
      const float noisy = std::sqrt(light) + 0.5F;
      codes[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(noisy < 255 ? noisy : 255));
    }
  }
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2")]] void expose_avx2(const std::uint16_t* codes64, std::uint8_t* codes,
                                         std::size_t count, std::uint64_t key,
                                         const NoiseRow::Factors& factors) {
  expose_row(codes64, codes, count, key, factors);
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

void NoiseRow::expose_plain(const std::uint16_t* codes64, std::uint8_t* codes, std::size_t count,
                            std::uint64_t key) const {
  expose_row(codes64, codes, count, key, factors_);
}

void NoiseRow::expose(const std::uint16_t* codes64, std::uint8_t* codes, std::size_t count,
                      std::uint64_t key) const {
#if defined(__x86_64__) && defined(__GNUC__)
  static const bool avx2 = __builtin_cpu_supports("avx2") != 0;
  if (avx2) return expose_avx2(codes64, codes, count, key, factors_);
#endif
  expose_plain(codes64, codes, count, key);
}

}  // namespace kaz::sim
