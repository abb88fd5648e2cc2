// Fronto-parallel blocks first; then, along the dominant slanted planes, blocks with that slant.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_match.h"

#include <algorithm>
#include <cmath>

namespace kaz::vision {
namespace {

constexpr int kAround = 16;    // disparities compared around a plane
constexpr float kOn_px = 1;    // a result further off the plane is not on it: its slant is unknown
constexpr float kNear_px = 3;  // a fronto-parallel result further off the plane is another object
// Largest cost of a slanted block relative to the fronto-parallel one. The latter is the minimum over all
// disparities, the former over kAround: with noise, the minimum of more values is smaller.
constexpr int kMaxCost_percent = 125;

// Pixels of a row where the plane of disparity start + slope u is possible.
void select_near_plane(const float* __restrict disparity, const std::uint8_t* __restrict textured,
                       int width, float start, float slope, std::uint8_t* __restrict wanted) {
  for (int u = 0; u < width; ++u) {
    const float d = disparity[u], off = std::abs(d - (start + slope * static_cast<float>(u)));
    wanted[u] = static_cast<std::uint8_t>((((d == 0) | (off < kNear_px)) ? 1 : 0) & textured[u]);
  }
}

}  // namespace

void StereoMatcher::match(const GreyPair& pair, int disparities, const MatchOptions& o,
                          std::vector<float>& disparity) {
  left_.filter(pair.left, pair.width, pair.height, o.block.vectors);
  right_.filter(pair.right, pair.width, pair.height, o.block.vectors);
  mirrored_.mirror(right_, disparities);
  const int min_texture =
      o.min_texture * o.block.block * o.block.block / 225;  // scaled from 15 x 15
  texture_.find(left_, o.block.block, min_texture, textured_);
  blocks_.match(left_, mirrored_, textured_, o.block, facing_);
  const int half = o.block.block / 2;
  disparity.resize(facing_.disparity.size());
  std::size_t i = 0;
  for (int v = 0; v < pair.height; ++v) {
    for (int u = 0; u < pair.width; ++u, ++i) {
      const float d = facing_.disparity[i];
      // A block that extends beyond the left border of the right image is not a match.
      const bool good = (facing_.good[i] != 0) & (d <= static_cast<float>(u - half));
      disparity[i] = good ? d : 0;
    }
  }
  if (o.slants == 0) return;
  for (const DisparityPlane& plane :
       slants_.find(disparity, pair.width, pair.height, o.block.block, o.slants))
    slant(plane, o, disparity);
}

void StereoMatcher::slant(const DisparityPlane& plane, const MatchOptions& o,
                          std::vector<float>& disparity) {
  constexpr float kMiddle = kAround / 2;
  const int half = o.block.block / 2;
  wanted_.resize(disparity.size());
  for (int v = 0; v < left_.height; ++v) {
    const std::size_t first = static_cast<std::size_t>(v) * static_cast<std::size_t>(left_.width);
    select_near_plane(&disparity[first], &textured_[first], left_.width,
                      plane.at(0, static_cast<float>(v)), plane.a, &wanted_[first]);
  }
  // Warp the right image by the plane: its points then have disparity kMiddle, and the block is
  // fronto-parallel to them.
  mirrored_.warp(right_, static_cast<double>(plane.a), static_cast<double>(plane.b),
                 static_cast<double>(plane.c - kMiddle), kAround);
  blocks_.match(left_, mirrored_, wanted_, o.block, slanted_);
  std::size_t i = 0;
  for (int v = 0; v < left_.height; ++v) {
    for (int u = 0; u < left_.width; ++u, ++i) {
      if (slanted_.good[i] == 0) continue;
      const float away = slanted_.disparity[i];
      if (std::abs(away - kMiddle) > kOn_px ||
          100 * slanted_.cost[i] > kMaxCost_percent * facing_.cost[i])
        continue;
      // Undo the warp: total disparity = residual disparity + the plane's at the warped pixel.
      const float moved = plane.at(static_cast<float>(u) - away, static_cast<float>(v));
      const float d = away + moved - kMiddle;
      if (d <= 0 || d > static_cast<float>(u - half)) continue;
      disparity[i] = d;
      facing_.cost[i] = std::min(slanted_.cost[i], facing_.cost[i]);  // for the next plane
    }
  }
}

}  // namespace kaz::vision
