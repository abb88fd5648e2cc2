// Loops over rows of small pixels, for every processor and for those with AVX2: rounded alike in both.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow_cells.h"

#include <algorithm>
#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_X86
#endif

namespace kaz::vision {
namespace {

// Of the pixels 1 .. width - 2; `to`: one row of each product.
[[gnu::always_inline]] inline void products(const float* __restrict up, const float* __restrict row,
                                            const float* __restrict down,
                                            const float* __restrict there,
                                            const float* __restrict compared, int width,
                                            float* __restrict to, std::size_t plane) {
  for (int x = 1; x + 1 < width; ++x) {
    const bool is = compared[x] != 0;
    const float q = row[x] - 128, d = there[x] - row[x];
    const float gx = (row[x + 1] - row[x - 1]) / 2, gy = (down[x] - up[x]) / 2;
    to[x] = is ? gx * gx : 0;
    to[plane + x] = is ? gx * gy : 0;
    to[2 * plane + x] = is ? gy * gy : 0;
    to[3 * plane + x] = is ? gx * d : 0;
    to[4 * plane + x] = is ? gy * d : 0;
    to[5 * plane + x] = is ? d * d : 0;
    to[6 * plane + x] = is ? d : 0;
    to[7 * plane + x] = is ? 1.0F : 0;
    to[8 * plane + x] = is ? gx : 0;
    to[9 * plane + x] = is ? gy : 0;
    to[10 * plane + x] = is ? q : 0;
    to[11 * plane + x] = is ? q * q : 0;
  }
}

// The order of the additions is part of the result.
[[gnu::always_inline]] inline void add_seven(const float* __restrict from, std::size_t step,
                                             std::size_t count, float* __restrict to) {
  static_assert(kFlowPatch == 7);
  for (std::size_t i = 0; i < count; ++i) {
    float sum = from[i];
    sum += from[i + step];
    sum += from[i + 2 * step];
    sum += from[i + 3 * step];
    sum += from[i + 4 * step];
    sum += from[i + 5 * step];
    sum += from[i + 6 * step];
    to[i] = sum;
  }
}

[[gnu::always_inline]] inline void judge(const FlowProducts::Rows& s,
                                         const float* __restrict compared, int width,
                                         const FlowLimits& limits, float* __restrict to_xx,
                                         float* __restrict to_xy, float* __restrict to_yy) {
  constexpr float kMinShare = 0.5F;  // of the patch that was compared
  constexpr float kPixels = kFlowPatch * kFlowPatch;
  const float *gxgx = s[0], *gxgy = s[1], *gygy = s[2], *gxd = s[3], *gyd = s[4], *dd = s[5],
              *ds = s[6], *weight = s[7], *gx = s[8], *gy = s[9], *qs = s[10], *qq = s[11];
  const float max_unlike = limits.max_unlike, error2 = limits.error2, step2 = limits.step2;
  for (int x = 0; x < width; ++x) {
    const float w = weight[x];
    const float xx = gxgx[x] / w, xy = gxgy[x] / w, yy = gygy[x] / w;
    const float lesser = (xx + yy) / 2 - std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy);
    const float d = ds[x] / w, q = qs[x] / w;
    const float unlike = dd[x] / w - d * d, varies = qq[x] / w - q * q;
    const float residual = unlike < kFlowNoise2 ? kFlowNoise2 : unlike;
    const float bx = gxd[x] / w - d * gx[x] / w, by = gyd[x] / w - d * gy[x] / w;
    const float det = xx * yy - xy * xy;
    const float sx = (yy * bx - xy * by) / det, sy = (xx * by - xy * bx) / det;
    // Where too few pixels were compared the means are not finite, and not used.
    const bool valid = (compared[x] != 0) & (w >= kMinShare * kPixels) & (lesser > 0) &
                       (unlike <= max_unlike * varies + kFlowNoise2) &
                       (residual <= error2 * kPixels * lesser) & (sx * sx + sy * sy <= step2);
    const float per = kPixels / (residual * kFlowSmall * kFlowSmall);
    to_xx[x] = valid ? per * xx : 0;
    to_xy[x] = valid ? per * xy : 0;
    to_yy[x] = valid ? per * yy : 0;
  }
}

#ifdef KAZ_X86
[[gnu::target("avx2")]] void products_avx2(const float* up, const float* row, const float* down,
                                           const float* there, const float* compared, int width,
                                           float* to, std::size_t plane) {
  products(up, row, down, there, compared, width, to, plane);
}
[[gnu::target("avx2")]] void add_seven_avx2(const float* from, std::size_t step, std::size_t count,
                                            float* to) {
  add_seven(from, step, count, to);
}
[[gnu::target("avx2")]] void judge_avx2(const FlowProducts::Rows& sums, const float* compared,
                                        int width, const FlowLimits& limits,
                                        const FlowCertaintyRow& to) {
  judge(sums, compared, width, limits, to.xx, to.xy, to.yy);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

void add_patch(const float* from, std::size_t step, std::size_t count, float* to, bool vectors) {
#ifdef KAZ_X86
  if (vectors && has_avx2()) return add_seven_avx2(from, step, count, to);
#endif
  (void)vectors;
  add_seven(from, step, count, to);
}

}  // namespace

void FlowProducts::resize(int width, int height) {
  if (width == width_ && height == height_) return;  // what set_row() leaves out is 0 already
  width_ = width;
  height_ = height;
  pitch_ = static_cast<std::size_t>(width + kFlowPatch);
  plane_ = pitch_ * static_cast<std::size_t>(height + kFlowPatch);
  memory_.assign(kCount * plane_, 0);
  columns_.resize(kCount * pitch_);
  sums_.resize(kCount * pitch_);
}

void FlowProducts::set_row(int y, const float* up, const float* row, const float* down,
                           const float* there, const float* compared) {
  float* to = &memory_[at(y) + kFlowPatch / 2];
#ifdef KAZ_X86
  if (vectors_ && has_avx2())
    return products_avx2(up, row, down, there, compared, width_, to, plane_);
#endif
  products(up, row, down, there, compared, width_, to, plane_);
}

FlowProducts::Rows FlowProducts::sum_row(int y) {
  Rows rows{};
  const std::size_t first = at(y) - kFlowPatch / 2 * pitch_;
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t k = 0; k < kCount; ++k) {
    float *columns = &columns_[k * pitch_], *sums = &sums_[k * pitch_];
    add_patch(plane(k) + first, pitch_, pitch_, columns, vectors_);
    add_patch(columns, 1, width, sums, vectors_);
    rows[k] = sums;
  }
  return rows;
}

void judge_flow_row(const FlowProducts::Rows& sums, const float* compared, int width,
                    const FlowLimits& limits, const FlowCertaintyRow& to, bool vectors) {
#ifdef KAZ_X86
  if (vectors && has_avx2()) return judge_avx2(sums, compared, width, limits, to);
#endif
  (void)vectors;
  judge(sums, compared, width, limits, to.xx, to.xy, to.yy);
}

}  // namespace kaz::vision
