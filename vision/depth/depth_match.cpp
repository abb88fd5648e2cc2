// Fronto-parallel blocks first; then, along the dominant slanted planes, blocks with that slant.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_match.h"

#include <algorithm>

#include "vision/depth/depth_rows.h"

namespace kaz::vision {

void StereoMatcher::match(const GreyPair& pair, int disparities, const MatchOptions& o,
                          std::vector<float>& disparity) {
  const bool vectors = o.block.vectors;
  left_.filter(pair.left, pair.width, pair.height, vectors);
  right_.filter(pair.right, pair.width, pair.height, vectors);
  mirrored_.mirror(right_, disparities, vectors);
  const int min_texture =
      o.min_texture * o.block.block * o.block.block / 225;  // scaled from 15 x 15
  texture_.find(left_, o.block.block, min_texture, vectors, textured_);
  fixed_ = textured_;
  aperture_.clear(pair.left, pair.width, pair.height, o.block.block, vectors, fixed_);
  const auto width = static_cast<std::size_t>(pair.width);
  const std::size_t pixels = width * static_cast<std::size_t>(pair.height);
  const int half = o.block.block / 2, end = pair.height - half;
  disparity.resize(pixels);
  cost_.resize(pixels);
  const auto border = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(half) * width);
  std::fill(disparity.begin(), disparity.begin() + border, 0.0F);
  std::fill(disparity.end() - border, disparity.end(), 0.0F);
  blocks_.begin(left_, mirrored_, o.block);
  for (int v = half; v < end; ++v) {
    const std::size_t first = static_cast<std::size_t>(v) * width;
    take_row(blocks_.row(v, &fixed_[first]), &disparity[first], &cost_[first], vectors);
  }
  if (o.slants == 0) return;
  for (const DisparityPlane& plane :
       slants_.find(disparity, pair.width, pair.height, o.block.block, o.slants, vectors))
    slant(plane, o, disparity);
}

void StereoMatcher::slant(const DisparityPlane& plane, const MatchOptions& o,
                          std::vector<float>& disparity) {
  const bool vectors = o.block.vectors;
  const int half = o.block.block / 2, end = left_.height - half;
  const auto width = static_cast<std::size_t>(left_.width);
  wanted_.assign(width + kVectorMargin, 0);
  // Warp the right image by the plane: its points then have disparity kAround / 2, and the block is
  // fronto-parallel to them.
  mirrored_.warp(right_, static_cast<double>(plane.a), static_cast<double>(plane.b),
                 static_cast<double>(plane.c - kAround / 2), kAround, vectors);
  blocks_.begin(left_, mirrored_, o.block);
  for (int v = half; v < end; ++v) {
    const std::size_t first = static_cast<std::size_t>(v) * width;
    if (!near_row(plane, v, &disparity[first], &textured_[first], left_.width, wanted_.data(),
                  vectors))
      continue;
    take_slanted_row(blocks_.row(v, wanted_.data()), plane, v, &disparity[first], &cost_[first],
                     vectors);
  }
}

}  // namespace kaz::vision
