// Blocks facing the eyes first; then, where these lie on slanted planes, blocks slanted alike.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth_match.h"

#include <algorithm>
#include <cmath>

namespace kaz::vision {
namespace {

constexpr int kAround = 16;  // disparities compared around a plane
constexpr float kOn_px =
    1;  // what is further off it does not lie on it, and its slant is not known
constexpr float kNear_px = 3;  // what blocks facing the eyes find further off it is another thing
// Blocks facing the eyes have the least of all disparities' costs, slanted ones only of those
// around the plane, and noise makes the least of more ones smaller. How much larger a slanted
// block's cost may be and still count as not worse.
constexpr int kNotWorse_percent = 125;

}  // namespace

void StereoMatcher::match(const GreyPair& pair, int disparities, const MatchOptions& o,
                          std::vector<float>& disparity) {
  left_.filter(pair.left, pair.width, pair.height);
  right_.filter(pair.right, pair.width, pair.height);
  mirrored_.mirror(right_, disparities);
  const int least = o.least_texture * o.block.block * o.block.block / 225;
  texture_.find(left_, o.block.block, least, textured_);
  blocks_.match(left_, mirrored_, textured_, o.block, facing_);
  const int half = o.block.block / 2;
  disparity.resize(facing_.size());
  std::size_t i = 0;
  for (int v = 0; v < pair.height; ++v) {
    for (int u = 0; u < pair.width; ++u, ++i) {
      const BlockMatch& m = facing_[i];
      // A block that would reach into the columns before the right picture has matched nothing.
      const bool good = (m.good != 0) & (m.disparity <= static_cast<float>(u - half));
      disparity[i] = good ? m.disparity : 0;
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
  std::size_t i = 0;
  for (int v = 0; v < left_.height; ++v) {
    for (int u = 0; u < left_.width; ++u, ++i) {
      const float d = disparity[i];
      const float off = std::abs(d - plane.at(static_cast<float>(u), static_cast<float>(v)));
      wanted_[i] = static_cast<std::uint8_t>((d == 0) | (off < kNear_px) ? textured_[i] : 0);
    }
  }
  mirrored_.warp(right_, static_cast<double>(plane.a), static_cast<double>(plane.b),
                 static_cast<double>(plane.c - kMiddle), kAround);
  blocks_.match(left_, mirrored_, wanted_, o.block, slanted_);
  i = 0;
  for (int v = 0; v < left_.height; ++v) {
    for (int u = 0; u < left_.width; ++u, ++i) {
      const BlockMatch& m = slanted_[i];
      if (m.good == 0 || std::abs(m.disparity - kMiddle) > kOn_px ||
          100 * m.cost > kNotWorse_percent * facing_[i].cost)
        continue;
      // The moved pixel u - m.disparity of the right picture is where the plane had put it.
      const float moved = plane.at(static_cast<float>(u) - m.disparity, static_cast<float>(v));
      const float d = m.disparity + moved - kMiddle;
      if (d <= 0 || d > static_cast<float>(u - half)) continue;
      disparity[i] = d;
      facing_[i].cost = std::min(m.cost, facing_[i].cost);  // for the planes after this one
    }
  }
}

}  // namespace kaz::vision
