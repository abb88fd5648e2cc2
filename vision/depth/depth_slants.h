// Finds dominant slanted planes of a disparity image by RANSAC, for the second pass of the block matching.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

class SlantFinder {
 public:
  // Returns up to `max_planes` planes with at least a tenth of the sampled pixels as inliers, largest first.
  // Leaves out planes whose slant over `block` px is too small for a second matching to have an effect. A
  // disparity of 0 means unknown. Pixel coordinates count from the image corner. The same image gives the
  // same planes. The result is valid until the next call.
  const std::vector<DisparityPlane>& find(const std::vector<float>& disparity, int width,
                                          int height, int block, int max_planes, bool vectors);

 private:
  // Positions and disparities (px) of the sampled pixels that do not belong to a plane yet.
  std::vector<float> u_, v_, d_;
  std::vector<DisparityPlane> planes_;

  int count(const DisparityPlane& plane, float band, bool vectors) const;
  bool refine(DisparityPlane& plane, float band) const;
  void erase(const DisparityPlane& plane, float band);
};

}  // namespace kaz::vision
