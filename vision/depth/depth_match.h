// Disparity of two grey pictures by blocks that face the eyes or lie in the scene's planes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vision/depth/depth_blocks.h"
#include "vision/depth/depth_slants.h"

namespace kaz::vision {

struct MatchOptions {
  BlockOptions block;
  int min_texture = 1000;  // over a block of 15 x 15
  int slants = 2;          // planes that blocks are slanted like
};

struct GreyPair {
  const std::uint8_t *left, *right;
  int width, height;
};

class StereoMatcher {
 public:
  // Disparities a multiple of 16; those of 0 in the result are unknown.
  void match(const GreyPair& pair, int disparities, const MatchOptions& options,
             std::vector<float>& disparity);

 private:
  FilteredPicture left_, right_;
  MirroredPicture mirrored_;
  BlockMatcher blocks_;
  BlockTexture texture_;
  SlantFinder slants_;
  BlockMatches facing_, slanted_;
  std::vector<std::uint8_t> textured_, wanted_;

  // Puts what lies on the plane where blocks slanted like it find it.
  void slant(const DisparityPlane& plane, const MatchOptions& options,
             std::vector<float>& disparity);
};

}  // namespace kaz::vision
