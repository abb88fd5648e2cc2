// Loops over rows, for every processor and for those with AVX2: rounded alike in both.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow_scale.h"

#include <algorithm>
#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_X86
#endif

namespace kaz::vision {
namespace {

// Sums of columns of four pixels, then of four neighbours. s / 16 to the nearest, of two the even one: with
// the last bit q of floor(s / 16), (s + 7 + q) / 16.
[[gnu::always_inline]] inline void quarter_row(const std::uint8_t* __restrict a, int pitch,
                                               int small, std::uint16_t* __restrict columns,
                                               std::uint8_t* __restrict to) {
  const std::uint8_t *b = a + pitch, *c = b + pitch, *d = c + pitch;
  for (int u = 0; u < 4 * small; ++u)
    columns[u] = static_cast<std::uint16_t>(a[u] + b[u] + c[u] + d[u]);
  for (int u = 0; u < small; ++u) {
    const int sum = columns[4 * u] + columns[4 * u + 1] + columns[4 * u + 2] + columns[4 * u + 3];
    to[u] = static_cast<std::uint8_t>((sum + 7 + (sum >> 4 & 1)) >> 4);
  }
}

[[gnu::always_inline]] inline void blend(const float* __restrict above,
                                         const float* __restrict below, float a0, float a1,
                                         float factor, int count, float* __restrict to) {
  for (int i = 0; i < count; ++i) to[i] = (above[i] * a0 + below[i] * a1) * factor;
}

#ifdef KAZ_X86
[[gnu::target("avx2")]] void quarter_row_avx2(const std::uint8_t* a, int pitch, int small,
                                              std::uint16_t* columns, std::uint8_t* to) {
  quarter_row(a, pitch, small, columns, to);
}
[[gnu::target("avx2")]] void blend_avx2(const float* above, const float* below, float a0, float a1,
                                        float factor, int count, float* to) {
  blend(above, below, a0, a1, factor, count, to);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

}  // namespace

void quarter(const std::uint8_t* grey, int width, int height, std::uint8_t* to) {
  const int small = width / 4;
  std::vector<std::uint16_t> columns(static_cast<std::size_t>(width));
  for (int v = 0; v + 4 <= height; v += 4, to += small) {
    const std::uint8_t* from = grey + static_cast<std::ptrdiff_t>(v) * width;
#ifdef KAZ_X86
    if (has_avx2()) {
      quarter_row_avx2(from, width, small, columns.data(), to);
      continue;
    }
#endif
    quarter_row(from, width, small, columns.data(), to);
  }
}

// Pixel i of the full picture has its centre at (i + 0.5) small / full - 0.5 of the small one.
std::vector<FlowEnlarger::Tap> FlowEnlarger::taps(int small, int full) {
  std::vector<Tap> all;
  const double scale = static_cast<double>(small) / full;
  for (int i = 0; i < full; ++i) {
    const auto centre = static_cast<float>((i + 0.5) * scale - 0.5);
    const int at = static_cast<int>(std::floor(centre));
    const float part = centre - static_cast<float>(at);
    all.push_back({at, 1 - part, part});
  }
  return all;
}

void FlowEnlarger::resize(Size small, Size full) {
  if (small == small_ && full == full_) return;
  small_ = small;
  full_ = full;
  across_ = taps(small.width, full.width);
  // Beyond the outermost centres the row is constant.
  for (Tap& tap : across_) {
    if (tap.at < 0) tap = {0, 1, 0};
    if (tap.at >= small.width - 1) tap = {std::max(0, small.width - 2), 0, 1};
  }
  down_ = taps(small.height, full.height);
  rows_.resize(static_cast<std::size_t>(small.height) * static_cast<std::size_t>(full.width) * 2);
}

void FlowEnlarger::enlarge_row(const float* small, float* to) const {
  for (const Tap& tap : across_) {
    const float* from = small + 2 * static_cast<std::ptrdiff_t>(tap.at);
    to[0] = from[0] * tap.a0 + from[2] * tap.a1;
    to[1] = from[1] * tap.a0 + from[3] * tap.a1;
    to += 2;
  }
}

void FlowEnlarger::enlarge(const float* small, float factor, float* full) {
  const int count = 2 * full_.width;
  const auto row = [&](int v) {
    return &rows_[static_cast<std::size_t>(v) * static_cast<std::size_t>(count)];
  };
  for (int v = 0; v < small_.height; ++v)
    enlarge_row(small + static_cast<std::ptrdiff_t>(v) * 2 * small_.width, row(v));
  for (const Tap& tap : down_) {
    // Beyond the outermost rows both are the same.
    const float* above = row(std::clamp(tap.at, 0, small_.height - 1));
    const float* below = row(std::clamp(tap.at + 1, 0, small_.height - 1));
#ifdef KAZ_X86
    if (has_avx2()) {
      blend_avx2(above, below, tap.a0, tap.a1, factor, count, full);
      full += count;
      continue;
    }
#endif
    blend(above, below, tap.a0, tap.a1, factor, count, full);
    full += count;
  }
}

}  // namespace kaz::vision
