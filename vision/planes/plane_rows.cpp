// Loops over rows of pixels, for every processor and for those with AVX2: rounded alike in both.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/plane_rows.h"

#include <algorithm>
#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_X86
#endif

namespace kaz::vision {
namespace {

[[gnu::always_inline]] inline void add(const float* __restrict d, std::size_t pixels,
                                       float* __restrict sum, float* __restrict min,
                                       float* __restrict max, int* __restrict count) {
  for (std::size_t x = 0; x < pixels; ++x) {
    const bool known = (d[x] > 0) & (d[x] < kMaxDisparity_px);
    sum[x] += known ? d[x] : 0.0F;
    const float low = known ? d[x] : kMaxDisparity_px, high = known ? d[x] : 0.0F;
    min[x] = low < min[x] ? low : min[x];
    max[x] = high > max[x] ? high : max[x];
    count[x] += known ? 1 : 0;
  }
}

[[gnu::always_inline]] inline void label(const float* __restrict d, std::size_t pixels,
                                         const RowPlane& plane, std::uint8_t* __restrict labels,
                                         float* __restrict square, int* __restrict count) {
  const RowPlane p = plane;
  const int end = static_cast<int>(pixels);
  for (int x = 0; x < end; ++x) {
    const float r = d[x] - (p.start + p.slope * static_cast<float>(x));
    const bool on = (std::abs(r) < p.tolerance) & (d[x] > 0);
    square[x] += on ? r * r : 0.0F;
    count[x] += on ? 1 : 0;
    labels[x] = static_cast<std::uint8_t>(on ? static_cast<int>(p.label) : 0);
  }
}

#ifdef KAZ_X86
[[gnu::target("avx2")]] void add_avx2(const float* d, std::size_t pixels, const ColumnSums& s) {
  add(d, pixels, s.sum, s.min, s.max, s.count);
}
[[gnu::target("avx2")]] void label_avx2(const float* d, std::size_t pixels, const RowPlane& plane,
                                        std::uint8_t* labels, float* square, int* count) {
  label(d, pixels, plane, labels, square, count);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

}  // namespace

void add_row(const float* disparity, std::size_t pixels, const ColumnSums& sums, bool vectors) {
#ifdef KAZ_X86
  if (vectors && has_avx2()) return add_avx2(disparity, pixels, sums);
#endif
  (void)vectors;
  add(disparity, pixels, sums.sum, sums.min, sums.max, sums.count);
}

void label_row(const float* disparity, std::size_t pixels, const RowPlane& plane,
               std::uint8_t* labels, float* square, int* count, bool vectors) {
#ifdef KAZ_X86
  if (vectors && has_avx2()) return label_avx2(disparity, pixels, plane, labels, square, count);
#endif
  (void)vectors;
  label(disparity, pixels, plane, labels, square, count);
}

}  // namespace kaz::vision
