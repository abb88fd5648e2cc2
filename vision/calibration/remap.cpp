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

// Functions instead of lambdas, which would not have the instructions of the function around them.
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i two_vectors(__m128i low, __m128i high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
}

// Eight bytes at each of four taps.
template <class Tap>
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i four_pixels(const std::uint8_t* from,
                                                                       const Tap* tap) {
  const auto two = [&](int i) {
    return _mm_unpacklo_epi64(eight_bytes(from + tap[i].offset),
                              eight_bytes(from + tap[i + 1].offset));
  };
  return two_vectors(two(0), two(2));
}

// Pixels of the taps `tap` and `tap` + 2 out of bytes of the upper and the lower row in turn.
template <class Tap>
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i mixed(__m256i bytes, const Tap* tap) {
  // Out of a tap's 16 bytes, of which the last four are not its own: `upper`, `lower` eight times; `left` and
  // `right` three times each.
  const __m256i row_bytes = _mm256_set1_epi16(0x0504);
  const __m256i column_bytes = _mm256_broadcastsi128_si256(
      _mm_setr_epi8(8, 9, 8, 9, 8, 9, 10, 11, 10, 11, 10, 11, -1, -1, -1, -1));
  const __m256i taps = two_vectors(_mm_loadu_si128(reinterpret_cast<const __m128i*>(tap)),
                                   _mm_loadu_si128(reinterpret_cast<const __m128i*>(tap + 2)));
  // upper u + lower l = upper (u - 128) + lower (l - 128) + 128^2, as one factor of bytes has a sign.
  const __m256i rows = _mm256_maddubs_epi16(_mm256_shuffle_epi8(taps, row_bytes),
                                            _mm256_xor_si256(bytes, _mm256_set1_epi8(-128)));
  const __m256i parts = _mm256_mulhi_epu16(_mm256_add_epi16(rows, _mm256_set1_epi16(128 * 128)),
                                           _mm256_shuffle_epi8(taps, column_bytes));
  return _mm256_add_epi16(parts, _mm256_srli_si256(parts, 6));
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
      tap->upper = static_cast<std::uint8_t>(128 - y.fraction);
      tap->lower = static_cast<std::uint8_t>(y.fraction);
      tap->left = static_cast<std::uint16_t>(std::lround(256 * gain * (128 - x.fraction)));
      tap->right = static_cast<std::uint16_t>(std::lround(256 * gain * x.fraction));
      if (pixel == last) at_end_[static_cast<std::size_t>(v)] = 1;
    }
  }
}

std::vector<Remap::Columns> Remap::all_rows() const {
  return std::vector<Columns>(static_cast<std::size_t>(size_.height), Columns{0, size_.width});
}

std::vector<Remap::Columns> Remap::sources(std::span<const Columns> wanted) const {
  std::vector<Columns> used(static_cast<std::size_t>(source_.height));
  for (int v = 0; v < size_.height; ++v) {
    const Columns columns = wanted[static_cast<std::size_t>(v)];
    for (int u = columns.first; u < columns.end; ++u) {
      const Tap& tap = taps_of(v)[u];
      if (tap.left == 0 && tap.right == 0) continue;  // black, whatever the source
      const auto pixel = static_cast<int>(tap.offset / 3);
      const int column = pixel % source_.width;
      const auto row = static_cast<std::size_t>(pixel / source_.width);
      for (Columns* of : {&used[row], &used[row + 1]}) {
        *of = of->end == 0 ? Columns{column, column + 2}
                           : Columns{std::min(of->first, column), std::max(of->end, column + 2)};
      }
    }
  }
  return used;
}

void Remap::row_plain(std::span<const std::uint8_t> source_rgb, int v, Columns columns,
                      std::uint16_t* out) const {
  const std::size_t below = 3 * static_cast<std::size_t>(source_.width);
  out += 3 * static_cast<std::ptrdiff_t>(columns.first);
  const Tap* tap = taps_of(v) + columns.first;
  for (int u = columns.first; u < columns.end; ++u, ++tap) {
    const std::uint8_t* upper = source_rgb.data() + tap->offset;
    const std::uint8_t* lower = upper + below;
    const std::uint32_t up = tap->upper, down = tap->lower;
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
void Remap::row_sse2(const std::uint8_t* source_rgb, int v, Columns columns,
                     std::uint16_t* out) const {
  const std::size_t below = 3 * static_cast<std::size_t>(source_.width);
  out += 3 * static_cast<std::ptrdiff_t>(columns.first);
  const Tap* tap = taps_of(v) + columns.first;
  const __m128i zero = _mm_setzero_si128();
  const auto two_pixels = [&](const std::uint8_t* from) {
    return _mm_unpacklo_epi8(eight_bytes(from), zero);
  };
  for (int u = columns.first; u < columns.end; ++u, ++tap, out += 3) {
    const std::uint8_t* from = source_rgb + tap->offset;
    const __m128i upper = two_pixels(from), lower = two_pixels(from + below);
    const __m128i down = _mm_set1_epi16(static_cast<short>(tap->lower));
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

// The same for four pixels at a time: in one vector of 16-bit numbers the first and the third, in another the
// second and the fourth.
[[gnu::target("avx2")]] void Remap::row_avx2(const std::uint8_t* source_rgb, int v, Columns columns,
                                             std::uint16_t* out) const {
  static_assert(sizeof(Tap) == 12 && offsetof(Tap, upper) == 4 && offsetof(Tap, lower) == 5 &&
                offsetof(Tap, left) == 8 && offsetof(Tap, right) == 10);
  const std::size_t below = 3 * static_cast<std::size_t>(source_.width);
  const Tap* tap = taps_of(v) + columns.first;
  std::uint16_t* to = out + 3 * static_cast<std::ptrdiff_t>(columns.first);
  int u = columns.first;
  for (; u + 4 <= columns.end; u += 4, tap += 4, to += 12) {
    const __m256i upper = four_pixels(source_rgb, tap),
                  lower = four_pixels(source_rgb + below, tap);
    const __m256i even = mixed(_mm256_unpacklo_epi8(upper, lower), tap);
    const __m256i odd = mixed(_mm256_unpackhi_epi8(upper, lower), tap + 1);
    const auto store = [&](int i, __m128i pixel) {
      _mm_storel_epi64(reinterpret_cast<__m128i*>(to + 3 * static_cast<std::ptrdiff_t>(i)), pixel);
    };
    store(0, _mm256_castsi256_si128(
                 even));  // in this order: each overwrites the end of the one before
    store(1, _mm256_castsi256_si128(odd));
    store(2, _mm256_extracti128_si256(even, 1));
    store(3, _mm256_extracti128_si256(odd, 1));
  }
  row_sse2(source_rgb, v, {u, columns.end}, out);
}
#endif

void Remap::row(std::span<const std::uint8_t> source_rgb, int v, Columns columns,
                std::uint16_t* out) const {
  if (columns.end <= columns.first) return;
#if defined(__x86_64__)
  if (at_end_[static_cast<std::size_t>(v)] != 0) return row_plain(source_rgb, v, columns, out);
  static const bool avx2 = __builtin_cpu_supports("avx2") != 0;
  if (avx2) return row_avx2(source_rgb.data(), v, columns, out);
  row_sse2(source_rgb.data(), v, columns, out);
#else
  row_plain(source_rgb, v, columns, out);
#endif
}

void Remap::apply(std::span<const std::uint8_t> source_rgb, std::vector<std::uint8_t>& rgb) const {
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(size_.width);
  rgb.resize(row_bytes * static_cast<std::size_t>(size_.height));
  std::vector<std::uint16_t> codes(row_bytes + 8);
  std::uint8_t* to = rgb.data();
  for (int v = 0; v < size_.height; ++v, to += row_bytes) {
    row(source_rgb, v, {0, size_.width}, codes.data());
    const std::uint16_t* from = codes.data();
    for (std::size_t i = 0; i < row_bytes; ++i)
      to[i] = static_cast<std::uint8_t>((from[i] + 32) >> 6);
  }
}

}  // namespace kaz::vision
