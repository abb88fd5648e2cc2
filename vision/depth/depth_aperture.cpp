// Running sums of products of derivatives over blocks; integers only, so that vectors give the same sums.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_aperture.h"

#include <algorithm>
#include <cstdlib>

#include "vision/depth/depth_avx2.h"

namespace kaz::vision {
namespace {

// gx^2 and gx gy by 3 x 3 Sobel, at most 1020 each, so that 21 x 21 products have 29 bits; replaces the row's
// former products, and enters the difference into the columns' sums.
[[gnu::always_inline]] inline void enter_row(const std::uint8_t* above, const std::uint8_t* here,
                                             const std::uint8_t* below, int width,
                                             std::int32_t* __restrict xx,
                                             std::int32_t* __restrict xy,
                                             std::int32_t* __restrict sum_xx,
                                             std::int32_t* __restrict sum_xy) {
  for (int u = 1; u < width - 1; ++u) {
    const int gx = (above[u + 1] - above[u - 1]) + 2 * (here[u + 1] - here[u - 1]) +
                   (below[u + 1] - below[u - 1]);
    const int gy =
        (below[u - 1] + 2 * below[u] + below[u + 1]) - (above[u - 1] + 2 * above[u] + above[u + 1]);
    const int now_xx = gx * gx, now_xy = gx * gy;
    sum_xx[u] += now_xx - xx[u];
    sum_xy[u] += now_xy - xy[u];
    xx[u] = now_xx;
    xy[u] = now_xy;
  }
}
#ifdef KAZ_DEPTH_AVX2
KAZ_AVX2 void enter_row_avx2(const std::uint8_t* above, const std::uint8_t* here,
                             const std::uint8_t* below, int width, std::int32_t* xx,
                             std::int32_t* xy, std::int32_t* sum_xx, std::int32_t* sum_xy) {
  enter_row(above, here, below, width, xx, xy, sum_xx, sum_xy);
}
#endif

}  // namespace

void BlockAperture::clear(const std::uint8_t* grey, int width, int height, int block, bool vectors,
                          std::vector<std::uint8_t>& mask) {
  const auto pitch = static_cast<std::size_t>(width);
  const auto row_of = [&](int v) {
    return grey + static_cast<std::size_t>(std::clamp(v, 0, height - 1)) * pitch;
  };
  products_.assign(2 * pitch * static_cast<std::size_t>(block), 0);
  columns_.assign(2 * pitch, 0);
  std::int32_t *const sum_xx = columns_.data(), *const sum_xy = sum_xx + width;
  const int half = block / 2;
  for (int v = 0; v < height; ++v) {
    std::int32_t* const xx = &products_[2 * pitch * static_cast<std::size_t>(v % block)];
#ifdef KAZ_DEPTH_AVX2
    if (vectors && has_avx2())
      enter_row_avx2(row_of(v - 1), row_of(v), row_of(v + 1), width, xx, xx + width, sum_xx,
                     sum_xy);
    else
#endif
      enter_row(row_of(v - 1), row_of(v), row_of(v + 1), width, xx, xx + width, sum_xx, sum_xy);
    if (v + 1 < block) continue;
    std::uint8_t* const out = &mask[static_cast<std::size_t>(v - half) * pitch];
    std::int32_t block_xx = 0, block_xy = 0;
    for (int u = 0; u < width; ++u) {
      block_xx += sum_xx[u];
      block_xy += sum_xy[u];
      if (u + 1 < block) continue;
      out[u - half] &= std::abs(block_xy) <= kMaxAlong * block_xx ? 1 : 0;
      block_xx -= sum_xx[u + 1 - block];
      block_xy -= sum_xy[u + 1 - block];
    }
  }
  (void)vectors;
}

}  // namespace kaz::vision
