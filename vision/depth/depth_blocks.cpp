// Running block sums over the rows of two pictures.
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
  code.resize(pitch * static_cast<std::size_t>(h) + kVectorMargin);
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

void MirroredPicture::mirror(const FilteredPicture& picture, int n, bool vectors) {
  resize(picture, n);
  for (int v = 0; v < height; ++v) {
    std::uint8_t* to = &code[static_cast<std::size_t>(v) * pitch()];
    mirror_row(picture.row(v), width, to, vectors);
    std::memset(to + width, kFilterCap, static_cast<std::size_t>(n));
  }
}

void MirroredPicture::warp(const FilteredPicture& picture, double a, double b, double c, int n,
                           bool vectors) {
  resize(picture, n);
  // Linear interpolation of the right image at u - (a u + b v + c), 16.16 fixed point.
  constexpr int kOne = 1 << 16;
  const int step = static_cast<int>(std::lround((1 - a) * kOne));
  for (int v = 0; v < height; ++v) {
    // Position in the right image of column -n; it advances by 1 - a per column.
    const double first = -n * (1 - a) - (b * v + c);
    warp_row({picture.row(v), width, static_cast<std::int64_t>(std::floor(first * kOne)), step,
              &code[static_cast<std::size_t>(v) * pitch()], width + n},
             vectors);
  }
}

void BlockMatcher::begin(const FilteredPicture& left, const MirroredPicture& right,
                         const BlockOptions& o) {
  left_ = &left;
  right_ = &right;
  options_ = o;
  first_ = next_ = -1;
  const int n = right.disparities;
  const auto w = static_cast<std::size_t>(left.width), lanes = w + kVectorMargin;
  columns_.assign(w * static_cast<std::size_t>(n), 0);
  zero_.assign(right.pitch(), 0);
  window_.assign(static_cast<std::size_t>(n) + 2, INT16_MAX);
  windows_.resize(n == 16 ? lanes * 16 : 0);
  winners_.assign(5 * lanes, 0);
  claims_.resize(right.pitch());
  // Where the vectors of depth_rows_avx2.cpp have a disparity: of 32, 0..7, 16..23, 8..15, 24..31.
  place_.resize(static_cast<std::size_t>(n) + 2);
  for (int d = -1; d <= n; ++d) {
    const bool paired = d >= 0 && d < n / 32 * 32;
    const int place = paired ? (d & ~24) | (d & 8) << 1 | (d & 16) >> 1 : d;
    place_[static_cast<std::size_t>(d + 1)] = static_cast<std::int16_t>(place);
  }
  sums_.width = left.width;
  sums_.disparities = n;
  sums_.half = o.block / 2;
  sums_.columns = columns_.data();
  sums_.window = &window_[1];
  sums_.windows = windows_.data();
  sums_.place = &place_[1];
  sums_.claims = claims_.data();
  sums_.doubt_share = std::min(0xffff, o.uniqueness_percent * 65536 / 100);
  std::int16_t* winner = winners_.data();
  sums_.winners = {winner, winner + lanes, winner + 2 * lanes, winner + 3 * lanes,
                   winner + 4 * lanes};
  matched_ = {left.width,
              sums_.half,
              n,
              sums_.doubt_share,
              o.left_right_px < 0 ? INT32_MAX : o.left_right_px,
              sums_.winners,
              nullptr,
              sums_.claims};
}

const MatchedRow& BlockMatcher::row(int v, const std::uint8_t* wanted) {
  const int half = sums_.half, block = options_.block;
  if (next_ < 0) first_ = next_ = v - half;
  for (; next_ <= v + half; ++next_) {
    const bool leaves = next_ - block >= first_;
    sums_.left = left_->row(next_);
    sums_.right = right_->row(next_);
    sums_.left_gone = leaves ? left_->row(next_ - block) : zero_.data();
    sums_.right_gone = leaves ? right_->row(next_ - block) : zero_.data();
    sums_.full = next_ == v + half;
    sums_.wanted = wanted;
    match_row(sums_, options_.vectors);
  }
  matched_.wanted = wanted;
  return matched_;
}

void BlockTexture::find(const FilteredPicture& picture, int block, int min_sum, bool vectors,
                        std::vector<std::uint8_t>& textured) {
  const auto w = static_cast<std::size_t>(picture.width);
  textured.assign(w * static_cast<std::size_t>(picture.height) + kVectorMargin, 0);
  columns_.assign(w, 0);
  none_.assign(w, kFilterCap);
  for (int v = 0; v < picture.height; ++v) {
    std::uint8_t* middle =
        v + 1 < block ? nullptr : &textured[static_cast<std::size_t>(v - block / 2) * w];
    texture_row({picture.row(v), v < block ? none_.data() : picture.row(v - block), picture.width,
                 block, min_sum, columns_.data(), middle},
                vectors);
  }
}

}  // namespace kaz::vision
