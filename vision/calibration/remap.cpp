// Bilinear look-ups with vectors of 16-bit numbers.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/remap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace kaz::vision {
namespace {

constexpr double kFraction = 128;

struct Split {
  std::uint32_t whole = 0, fraction = 0;
};

// Of a coordinate on a side of `length` pixels; the pixel after `whole` exists too.
Split split(double at, int length) {
  const double limited = std::clamp(at, 0.0, length - 1.0 - 1 / kFraction);
  const auto fixed = static_cast<std::uint32_t>(std::lround(limited * kFraction));
  return {fixed / 128, fixed % 128};
}

#if defined(__x86_64__)
[[gnu::always_inline]] inline __m128i eight_bytes(const std::uint8_t* from) {
  return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(from));
}
#endif

}  // namespace

Remap::Remap(Size size, Size source, const std::function<Place(int u, int v)>& place)
    : size_(size), source_(source) {
  // One more: row_avx2() reads four bytes beyond a tap.
  taps_.resize(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) + 1);
  at_end_.assign(static_cast<std::size_t>(size.height), 0);
  const auto stride = static_cast<std::uint32_t>(source.width);
  const auto last = static_cast<std::uint32_t>(source.height - 2) * stride + stride - 2;
  Tap* tap = taps_.data();
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u, ++tap) {
      const Place from = place(u, v);
      // Written so that a place that is no number is outside.
      const bool inside = from.u >= -0.5 && from.u <= source.width - 0.5 && from.v >= -0.5 &&
                          from.v <= source.height - 0.5;
      if (!inside) continue;
      const Split x = split(from.u, source.width), y = split(from.v, source.height);
      const double gain = std::clamp(from.gain, 0.0, 1.0);
      const std::uint32_t pixel = y.whole * stride + x.whole;
      tap->offset = 3 * pixel;
      tap->down = static_cast<std::uint16_t>(y.fraction);
      tap->left = static_cast<std::uint16_t>(std::lround(256 * gain * (128 - x.fraction)));
      tap->right = static_cast<std::uint16_t>(std::lround(256 * gain * x.fraction));
      if (pixel == last) at_end_[static_cast<std::size_t>(v)] = 1;
    }
  }
}

void Remap::row_plain(std::span<const std::uint8_t> source_rgb, int v, std::uint16_t* out) const {
  const std::size_t below = 3 * static_cast<std::size_t>(source_.width);
  const auto width = static_cast<std::size_t>(size_.width);
  const Tap* tap = taps_.data() + static_cast<std::size_t>(v) * width;
  for (std::size_t u = 0; u < width; ++u, ++tap) {
    const std::uint8_t* upper = source_rgb.data() + tap->offset;
    const std::uint8_t* lower = upper + below;
    const std::uint32_t down = tap->down, up = 128 - down;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t left = upper[c] * up + lower[c] * down;
      const std::uint32_t right = upper[c + 3] * up + lower[c + 3] * down;
      const std::uint32_t sum = ((left * tap->left) >> 16) + ((right * tap->right) >> 16);
      *out++ = static_cast<std::uint16_t>(sum);
    }
  }
  *out = 0;
}

#if defined(__x86_64__)
// One pixel in a vector of eight 16-bit numbers: two neighbours of the source with three channels each.
void Remap::row_sse2(const std::uint8_t* source_rgb, int v, std::uint16_t* out) const {
  const std::size_t below = 3 * static_cast<std::size_t>(source_.width);
  const auto width = static_cast<std::size_t>(size_.width);
  const Tap* tap = taps_.data() + static_cast<std::size_t>(v) * width;
  const __m128i zero = _mm_setzero_si128();
  const auto two_pixels = [&](const std::uint8_t* from) {
    return _mm_unpacklo_epi8(eight_bytes(from), zero);
  };
  for (std::size_t u = 0; u < width; ++u, ++tap, out += 3) {
    const std::uint8_t* from = source_rgb + tap->offset;
    const __m128i upper = two_pixels(from), lower = two_pixels(from + below);
    const __m128i down = _mm_set1_epi16(static_cast<short>(tap->down));
    const __m128i column =
        _mm_add_epi16(_mm_slli_epi16(upper, 7), _mm_mullo_epi16(_mm_sub_epi16(lower, upper), down));
    std::int32_t both = 0;
    std::memcpy(&both, &tap->left, sizeof both);
    const __m128i pairs = _mm_shuffle_epi32(_mm_cvtsi32_si128(both), 0);
    const __m128i weights = _mm_shufflehi_epi16(_mm_shufflelo_epi16(pairs, 0x40), 0x05);
    const __m128i parts = _mm_mulhi_epu16(column, weights);
    const __m128i sum = _mm_add_epi16(parts, _mm_srli_si128(parts, 6));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(out), sum);
  }
  *out = 0;
}

// The same for two pixels at a time. An odd last pixel is drawn twice.
[[gnu::target("avx2")]] void Remap::row_avx2(const std::uint8_t* source_rgb, int v,
                                             std::uint16_t* out) const {
  static_assert(sizeof(Tap) == 12 && offsetof(Tap, down) == 4 && offsetof(Tap, left) == 8 &&
                offsetof(Tap, right) == 10);
  const std::size_t below = 3 * static_cast<std::size_t>(source_.width);
  const auto width = static_cast<std::size_t>(size_.width);
  const Tap* taps = taps_.data() + static_cast<std::size_t>(v) * width;
  // Out of a tap's 16 bytes, of which the last four are not its own: `down` eight times; `left` and `right`
  // three times each.
  const __m256i down_bytes = _mm256_set1_epi16(0x0504);
  const __m256i weight_bytes = _mm256_broadcastsi128_si256(
      _mm_setr_epi8(8, 9, 8, 9, 8, 9, 10, 11, 10, 11, 10, 11, -1, -1, -1, -1));
  for (std::size_t at = 0; at < width; at += 2) {
    const std::size_t u = at + 1 < width ? at : width - (width > 1 ? 2 : 1);
    const std::size_t next = width > 1 ? u + 1 : u;
    const __m256i both = _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(&taps[next]),
                                             reinterpret_cast<const __m128i*>(&taps[u]));
    const std::uint8_t *one = source_rgb + taps[u].offset, *two = source_rgb + taps[next].offset;
    const __m256i upper =
        _mm256_cvtepu8_epi16(_mm_unpacklo_epi64(eight_bytes(one), eight_bytes(two)));
    const __m256i lower = _mm256_cvtepu8_epi16(
        _mm_unpacklo_epi64(eight_bytes(one + below), eight_bytes(two + below)));
    const __m256i down = _mm256_shuffle_epi8(both, down_bytes);
    const __m256i column = _mm256_add_epi16(
        _mm256_slli_epi16(upper, 7), _mm256_mullo_epi16(_mm256_sub_epi16(lower, upper), down));
    const __m256i parts = _mm256_mulhi_epu16(column, _mm256_shuffle_epi8(both, weight_bytes));
    const __m256i sum = _mm256_add_epi16(parts, _mm256_srli_si256(parts, 6));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(out + 3 * u), _mm256_castsi256_si128(sum));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(out + 3 * next), _mm256_extracti128_si256(sum, 1));
  }
  out[3 * width] = 0;
}
#endif

void Remap::row(std::span<const std::uint8_t> source_rgb, int v, std::uint16_t* out) const {
#if defined(__x86_64__)
  if (at_end_[static_cast<std::size_t>(v)] != 0) return row_plain(source_rgb, v, out);
  static const bool avx2 = __builtin_cpu_supports("avx2") != 0;
  if (avx2) return row_avx2(source_rgb.data(), v, out);
  row_sse2(source_rgb.data(), v, out);
#else
  row_plain(source_rgb, v, out);
#endif
}

void Remap::apply(std::span<const std::uint8_t> source_rgb, std::vector<std::uint8_t>& rgb) const {
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(size_.width);
  rgb.resize(row_bytes * static_cast<std::size_t>(size_.height));
  std::vector<std::uint16_t> codes(row_bytes + 8);
  std::uint8_t* to = rgb.data();
  for (int v = 0; v < size_.height; ++v, to += row_bytes) {
    row(source_rgb, v, codes.data());
    const std::uint16_t* from = codes.data();
    for (std::size_t i = 0; i < row_bytes; ++i)
      to[i] = static_cast<std::uint8_t>((from[i] + 32) >> 6);
  }
}

}  // namespace kaz::vision
