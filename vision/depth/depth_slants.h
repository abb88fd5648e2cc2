// Dominant slanted planes of a disparity image, by RANSAC: the slants for a second block matching.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

class SlantFinder {
 public:
  // Up to `max_planes` planes with at least a tenth of the sampled pixels as inliers, the largest first;
  // only those whose slant over `block` px matters. Disparities of 0 are unknown. Pixel coordinates from
  // the image corner. Deterministic: same image, same planes.
  const std::vector<DisparityPlane>& find(const std::vector<float>& disparity, int width,
                                          int height, int block, int max_planes);

 private:
  struct Point {
    float u, v, d;
  };
  std::vector<Point> points_;
  std::vector<DisparityPlane> planes_;

  int count(const DisparityPlane& plane, float band) const;
  bool refine(DisparityPlane& plane, float band) const;
};

}  // namespace kaz::vision
