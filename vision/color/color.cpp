// Colour extraction in 16-bit integers, compiled for several vector widths and chosen at run time.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/color.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kaz::vision {

namespace {

constexpr double kPi = 3.14159265358979323846;
using Row = std::array<double, 3>;  // weights of R, G, B
constexpr Row kY{0.299, 0.587, 0.114}, kI{0.596, -0.274, -0.322}, kQ{0.211, -0.523, 0.312};

Row combine(double y, double i, double q) {
  Row row{};
  for (std::size_t c = 0; c < 3; ++c) row[c] = y * kY[c] + i * kI[c] + q * kQ[c];
  return row;
}

// weights . (R, G, B) >= threshold, scaled so that neither the positive nor the negative weights add up
// to more than 128: with components of at most 255 the sum then fits 16 bits.
ColorExtractor::HalfSpace quantised(const Row& weights, double threshold) {
  double positive = 0, negative = 0;
  for (const double w : weights) (w > 0 ? positive : negative) += std::abs(w);
  const double scale = 126.5 / std::max(positive, negative);
  const auto round = [&](double v) {
    return static_cast<std::int16_t>(std::lround(std::clamp(v * scale, -32767.0, 32767.0)));
  };
  return {round(weights[0]), round(weights[1]), round(weights[2]), round(threshold)};
}

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_X86 1
#endif

// One pass over the pixels for N half-spaces. Split into planes first, in blocks that stay in the
// cache: the second loop then is plain 16-bit arithmetic, which every compiler turns into vectors.
template <std::size_t N>
[[gnu::always_inline]] inline void extract_all(const std::uint8_t* rgb, std::uint8_t* mask,
                                               std::size_t pixels,
                                               const ColorExtractor::HalfSpace* spaces) {
  constexpr std::size_t kBlock = 512;
  std::int16_t r[kBlock], g[kBlock], b[kBlock];
  ColorExtractor::HalfSpace h[N];
  std::copy_n(spaces, N, h);
  for (std::size_t start = 0; start < pixels; start += kBlock) {
    const std::size_t n = std::min(kBlock, pixels - start);
    const std::uint8_t* from = rgb + 3 * start;
    std::uint8_t* to = mask + start;
    for (std::size_t i = 0; i < n; ++i) {
      r[i] = from[3 * i];
      g[i] = from[3 * i + 1];
      b[i] = from[3 * i + 2];
    }
    for (std::size_t i = 0; i < n; ++i) {
      std::int16_t inside = -1;
      for (std::size_t k = 0; k < N; ++k) {
        const auto sum = static_cast<std::int16_t>(h[k].r * r[i] + h[k].g * g[i] + h[k].b * b[i]);
        inside = static_cast<std::int16_t>(inside & (sum >= h[k].least ? -1 : 0));
      }
      to[i] = static_cast<std::uint8_t>(inside);
    }
  }
}

using Kernel = void (*)(const std::uint8_t*, std::uint8_t*, std::size_t,
                        const ColorExtractor::HalfSpace*);

template <std::size_t N>
void extract_plain(const std::uint8_t* rgb, std::uint8_t* mask, std::size_t pixels,
                   const ColorExtractor::HalfSpace* spaces) {
  extract_all<N>(rgb, mask, pixels, spaces);
}

#ifdef KAZ_X86
template <std::size_t N>
[[gnu::target("avx2")]] void extract_avx2(const std::uint8_t* rgb, std::uint8_t* mask,
                                          std::size_t pixels,
                                          const ColorExtractor::HalfSpace* spaces) {
  extract_all<N>(rgb, mask, pixels, spaces);
}
#endif

struct Kernels {
  Kernel plain, fast;
};

// By number of half-spaces, 1 to 10. Not target_clones: its resolvers run before the thread
// sanitizer does.
Kernels kernels_for(std::size_t count) {
#ifdef KAZ_X86
  static const bool avx2 = __builtin_cpu_supports("avx2") != 0;
#endif
  const auto table = []<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<Kernels, sizeof...(I)>{Kernels{extract_plain<I + 1>,
#ifdef KAZ_X86
                                                     extract_avx2<I + 1>
#else
                                                     extract_plain<I + 1>
#endif
    }...};
  }
  (std::make_index_sequence<10>{});
  Kernels kernels = table[count - 1];
#ifdef KAZ_X86
  if (!avx2) kernels.fast = kernels.plain;
#endif
  return kernels;
}

}  // namespace

Yiq yiq_from_rgb(double r, double g, double b) {
  const auto dot = [&](const Row& row) { return row[0] * r + row[1] * g + row[2] * b; };
  return {dot(kY), dot(kI), dot(kQ)};
}

ColorRange ColorRange::red_ball() {
  ColorRange range;
  range.y_min = 14;
  range.hue_min = 5.5 * kPi / 180;
  range.hue_max = 33.5 * kPi / 180;
  range.saturation_min = 0.4;
  return range;
}

ColorExtractor::ColorExtractor(const ColorRange& range) {
  const ColorRange all;
  const auto add = [this](const Row& weights, double threshold) {
    half_spaces_[count_++] = quantised(weights, threshold);
  };
  // Bounds that every colour meets are omitted, except the first, as there must be one.
  add(combine(1, 0, 0), std::max(range.y_min, 0.0));
  if (range.y_max < all.y_max) add(combine(-1, 0, 0), -range.y_max);
  if (range.i_min > all.i_min) add(combine(0, 1, 0), range.i_min);
  if (range.i_max < all.i_max) add(combine(0, -1, 0), -range.i_max);
  if (range.q_min > all.q_min) add(combine(0, 0, 1), range.q_min);
  if (range.q_max < all.q_max) add(combine(0, 0, -1), -range.q_max);
  if (range.hue_min != 0 || range.hue_max != 0) {
    add(combine(0, -std::sin(range.hue_min), std::cos(range.hue_min)), 0);
    add(combine(0, std::sin(range.hue_max), -std::cos(range.hue_max)), 0);
    const double middle = 0.5 * (range.hue_min + range.hue_max);
    add(combine(-range.saturation_min, std::cos(middle), std::sin(middle)), 0);
  }
}

bool ColorExtractor::contains(std::uint8_t r, std::uint8_t g, std::uint8_t b) const {
  for (const HalfSpace& h : half_spaces()) {
    if (h.r * r + h.g * g + h.b * b < h.least) return false;
  }
  return true;
}

void ColorExtractor::extract(const Image& image, Mask& mask) const {
  extract(image, mask, true);
}

void ColorExtractor::extract(const Image& image, Mask& mask, bool vectors) const {
  const std::size_t pixels =
      std::min(image.rgb.size() / 3, static_cast<std::size_t>(std::max(image.width, 0)) *
                                         static_cast<std::size_t>(std::max(image.height, 0)));
  mask.width = image.width;
  mask.height = image.height;
  mask.pixels.resize(pixels);
  const Kernels kernels = kernels_for(count_);
  (vectors ? kernels.fast : kernels.plain)(image.rgb.data(), mask.pixels.data(), pixels,
                                           half_spaces_.data());
}

}  // namespace kaz::vision
