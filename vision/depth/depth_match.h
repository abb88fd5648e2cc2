// Finds the disparity of two gray images by block matching with fronto-parallel and slanted blocks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vision/depth/depth_aperture.h"
#include "vision/depth/depth_blocks.h"
#include "vision/depth/depth_slants.h"

namespace kaz::vision {

struct MatchOptions {
  BlockOptions block;
  int min_texture = 1000;  // minimum sum over a block of 15 x 15 px, as in DepthOptions
  int slants = 2;          // maximum number of slanted planes for which matching is repeated
};

// View of two rectified gray images of equal size, 8 bits per pixel, no padding. Does not own the pixels.
struct GreyPair {
  const std::uint8_t *left, *right;
  int width, height;
};

class StereoMatcher {
 public:
  // Writes one disparity (px) per pixel of the left image; 0: unknown. `disparities` is the number of
  // disparities that are compared, a multiple of 16.
  void match(const GreyPair& pair, int disparities, const MatchOptions& options,
             std::vector<float>& disparity);

 private:
  FilteredPicture left_, right_;
  MirroredPicture mirrored_;
  BlockMatcher blocks_;
  BlockTexture texture_;
  BlockAperture aperture_;
  SlantFinder slants_;
  std::vector<std::uint8_t> textured_, fixed_, wanted_;
  std::vector<std::int16_t> cost_;  // by pixel: cost of the disparity that was found

  // Repeats the matching with blocks that are slanted like the plane. Only pixels near the plane and pixels
  // without a disparity are matched. Good matches replace the disparities of these pixels.
  void slant(const DisparityPlane& plane, const MatchOptions& options,
             std::vector<float>& disparity);
};

}  // namespace kaz::vision
