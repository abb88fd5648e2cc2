// Eight places at a time: their pixels side by side in vectors, through a sorting network.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/cell_disparity.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_X86
#endif

namespace kaz::vision {
namespace {

constexpr int kSide = 4;
constexpr std::size_t kPixels = kSide * kSide, kLanes = 8;
constexpr int kMinKnown = 6;
// Bits of floats above 0: as integers they have the same order.
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));
using Floats = float __attribute__((vector_size(4 * kLanes)));

// Odd-even merge sort of sixteen (K. E. Batcher, "Sorting networks and their applications", 1968).
constexpr std::size_t kComparators = 63;
constexpr auto kNetwork = [] {
  std::array<std::pair<std::size_t, std::size_t>, kComparators> network{};
  std::size_t count = 0;
  for (std::size_t p = 1; p < kPixels; p *= 2)
    for (std::size_t k = p; k >= 1; k /= 2)
      for (std::size_t j = k % p; j + k < kPixels; j += 2 * k)
        for (std::size_t i = 0; i < std::min(k, kPixels - j - k); ++i)
          if ((i + j) / (2 * p) == (i + j + k) / (2 * p)) network[count++] = {i + j, i + j + k};
  return network;
}();

template <std::size_t... I>
[[gnu::always_inline]] inline void sort(Ints* x, std::index_sequence<I...>) {
  const auto compare = [x](std::size_t a, std::size_t b) {
    const Ints less = x[a] < x[b] ? x[a] : x[b], more = x[a] < x[b] ? x[b] : x[a];
    x[a] = less;
    x[b] = more;
  };
  (compare(kNetwork[I].first, kNetwork[I].second), ...);
}

// The first of the pixels around a place.
const float* corner(const DepthImage& depth, const Eigen::Vector2i& place) {
  const int u = std::clamp(place.x() - kSide / 2, 0, depth.width - kSide);
  const int v = std::clamp(place.y() - kSide / 2, 0, depth.height - kSide);
  return depth.disparity_px.data() + static_cast<std::ptrdiff_t>(v) * depth.width + u;
}

[[gnu::always_inline]] inline void medians(const float* const* from, std::ptrdiff_t pitch,
                                           std::size_t count, float* to) {
  const Ints unknown = Ints{} + std::bit_cast<std::int32_t>(std::numeric_limits<float>::infinity());
  Ints pixel[kPixels], known{};  // pixel k of each place; unknown ones behind all others
#pragma GCC unroll 16
  for (std::size_t k = 0; k < kPixels; ++k) {
    const std::ptrdiff_t at =
        static_cast<std::ptrdiff_t>(k / kSide) * pitch + static_cast<std::ptrdiff_t>(k % kSide);
    const Floats d{from[0][at], from[1][at], from[2][at], from[3][at],
                   from[4][at], from[5][at], from[6][at], from[7][at]};
    const Ints is = d > 0;
    pixel[k] = is ? reinterpret_cast<Ints>(d) : unknown;
    known -= is;
  }
  sort(pixel, std::make_index_sequence<kComparators>());
  for (std::size_t k = 0; k < count; ++k)
    to[k] = known[k] < kMinKnown
                ? 0
                : std::bit_cast<float>(pixel[static_cast<std::size_t>(known[k] / 2)][k]);
}
#ifdef KAZ_X86
[[gnu::target("avx2")]] void medians_avx2(const float* const* from, std::ptrdiff_t pitch,
                                          std::size_t count, float* to) {
  medians(from, pitch, count, to);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

}  // namespace

void median_disparities(const DepthImage& depth, std::span<const Eigen::Vector2i> places,
                        float* to) {
  for (std::size_t first = 0; first < places.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, places.size() - first);
    std::array<const float*, kLanes> from{};
    for (std::size_t k = 0; k < kLanes; ++k)
      from[k] = corner(depth, places[first + std::min(k, count - 1)]);
#ifdef KAZ_X86
    if (has_avx2()) {
      medians_avx2(from.data(), depth.width, count, to + first);
      continue;
    }
#endif
    medians(from.data(), depth.width, count, to + first);
  }
}

}  // namespace kaz::vision
