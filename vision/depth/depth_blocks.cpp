// Running block sums and their minima.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "vision/depth/depth_rows.h"

namespace kaz::vision {

void FilteredPicture::filter(const std::uint8_t* grey, int w, int h, bool vectors) {
  width = w;
  height = h;
  const auto pitch = static_cast<std::size_t>(w);
  code.resize(pitch * static_cast<std::size_t>(h));
  for (int v = 0; v < h; ++v) {
    const std::uint8_t* here = grey + static_cast<std::size_t>(v) * pitch;
    filter_row(v > 0 ? here - pitch : here, here, v + 1 < h ? here + pitch : here, w,
               &code[static_cast<std::size_t>(v) * pitch], vectors);
  }
}

void MirroredPicture::resize(const FilteredPicture& picture, int n) {
  width = picture.width;
  height = picture.height;
  disparities = n;
  code.resize(pitch() * static_cast<std::size_t>(height));
}

void MirroredPicture::mirror(const FilteredPicture& picture, int n) {
  resize(picture, n);
  for (int v = 0; v < height; ++v) {
    std::uint8_t* to = &code[static_cast<std::size_t>(v) * pitch()];
    const std::uint8_t* from = picture.row(v);
    std::reverse_copy(from, from + width, to);
    std::memset(to + width, kFilterCap, static_cast<std::size_t>(n));
  }
}

void MirroredPicture::warp(const FilteredPicture& picture, double a, double b, double c, int n) {
  resize(picture, n);
  // Linear interpolation of the right image at u - (a u + b v + c), 16.16 fixed point.
  constexpr int kOne = 1 << 16;
  const int step = static_cast<int>(std::lround((1 - a) * kOne));
  const int end = (width - 1) * kOne;
  for (int v = 0; v < height; ++v) {
    std::uint8_t* to = &code[static_cast<std::size_t>(v) * pitch()];
    const std::uint8_t* from = picture.row(v);
    // Position in the right image of column -n; `at` advances by 1 - a per column.
    const double first = -n * (1 - a) - (b * v + c);
    auto at = static_cast<std::int64_t>(std::floor(first * kOne));
    for (int i = width + n - 1; i >= 0; --i, at += step) {
      if (at < 0 || at >= end) {
        to[i] = kFilterCap;
        continue;
      }
      const std::uint8_t* p = from + (at >> 16);
      const int part = static_cast<int>(at & 0xffff) >> 8;
      to[i] = static_cast<std::uint8_t>((p[0] * (256 - part) + p[1] * part + 128) >> 8);
    }
  }
}

void BlockMatcher::match(const FilteredPicture& left, const MirroredPicture& right,
                         const std::vector<std::uint8_t>& wanted, const BlockOptions& o,
                         BlockMatches& found) {
  const int width = left.width, height = left.height, n = right.disparities, half = o.block / 2;
  const auto w = static_cast<std::size_t>(width);
  const std::size_t pixels = w * static_cast<std::size_t>(height);
  found.disparity.resize(pixels);
  found.cost.resize(pixels);
  found.good.assign(pixels, 0);
  columns_.assign(w * static_cast<std::size_t>(n), 0);
  zero_.assign(right.pitch(), 0);
  window_.assign(static_cast<std::size_t>(n) + 2, INT16_MAX);
  winners_.assign(5 * w, 0);
  right_cost_.resize(right.pitch());
  right_disparity_.resize(right.pitch());
  BlockRow row;
  row.width = width;
  row.disparities = n;
  row.half = half;
  row.doubt_share = std::min(0xffff, o.uniqueness_percent * 65536 / 100);
  row.columns = columns_.data();
  row.window = &window_[1];
  row.right_cost = right_cost_.data();
  row.right_disparity = right_disparity_.data();
  std::int16_t* first_winner = winners_.data();
  RowWinners winners{first_winner, first_winner + w, first_winner + 2 * w, first_winner + 3 * w,
                     first_winner + 4 * w};
  for (int v = 0; v < height; ++v) {
    const bool first = v < o.block;
    row.left = left.row(v);
    row.right = right.row(v);
    row.left_gone = first ? zero_.data() : left.row(v - o.block);
    row.right_gone = first ? zero_.data() : right.row(v - o.block);
    const std::size_t middle = static_cast<std::size_t>(std::max(0, v - half)) * w;
    row.winners = v + 1 < o.block ? nullptr : &winners;
    row.wanted = &wanted[middle];
    match_row(row, o.vectors);
    if (row.winners == nullptr) continue;
    std::uint8_t* good = &found.good[middle];
    judge_row(winners, row.wanted, half, width - half, n, row.doubt_share,
              {&found.disparity[middle], &found.cost[middle], good}, o.vectors);
    if (o.left_right_px < 0) continue;
    for (int u = half; u < width - half; ++u) {
      const int d = winners.disparity[u];
      const int other = right_disparity_[static_cast<std::size_t>(width - 1 - u + d)];
      const int off = std::abs(other - d);
      good[u] = static_cast<std::uint8_t>(good[u] & (off <= o.left_right_px ? 1 : 0));
    }
  }
}

void BlockTexture::find(const FilteredPicture& picture, int block, int min_sum,
                        std::vector<std::uint8_t>& textured) {
  const int width = picture.width, height = picture.height, half = block / 2;
  const auto w = static_cast<std::size_t>(width);
  textured.assign(w * static_cast<std::size_t>(height), 0);
  columns_.assign(w, 0);
  for (int v = 0; v < height; ++v) {
    const std::uint8_t* in = picture.row(v);
    const std::uint8_t* out = v < block ? nullptr : picture.row(v - block);
    for (int u = 0; u < width; ++u) {
      columns_[static_cast<std::size_t>(u)] += std::abs(in[u] - kFilterCap);
      if (out != nullptr) columns_[static_cast<std::size_t>(u)] -= std::abs(out[u] - kFilterCap);
    }
    if (v + 1 < block) continue;
    std::uint8_t* to = &textured[static_cast<std::size_t>(v - half) * w];
    std::int32_t sum = 0;
    for (int u = 0; u < width; ++u) {
      sum += columns_[static_cast<std::size_t>(u)];
      if (u >= block) sum -= columns_[static_cast<std::size_t>(u - block)];
      if (u + 1 >= block) to[u - half] = sum >= min_sum ? 1 : 0;
    }
  }
}

}  // namespace kaz::vision
