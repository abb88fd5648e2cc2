// Dominant slanted planes of a disparity image, by RANSAC: the slants for a second block matching.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

class SlantFinder {
 public:
  // Up to `max_planes` planes with at least a tenth of the sampled pixels as inliers, the largest first;
  // only those whose slant over `block` px matters. Disparities of 0 are unknown. Pixel coordinates from
  // the image corner. Deterministic: same image, same planes.
  const std::vector<DisparityPlane>& find(const std::vector<float>& disparity, int width,
                                          int height, int block, int max_planes, bool vectors);

 private:
  // Of the sampled pixels that are on no plane yet, px.
  std::vector<float> u_, v_, d_;
  std::vector<DisparityPlane> planes_;

  int count(const DisparityPlane& plane, float band, bool vectors) const;
  bool refine(DisparityPlane& plane, float band) const;
  void erase(const DisparityPlane& plane, float band);
};

}  // namespace kaz::vision
