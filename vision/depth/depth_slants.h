// Slanted planes in a disparity picture, by sample: what blocks are to be slanted like.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "vision/depth/disparity_plane.h"

namespace kaz::vision {

class SlantFinder {
 public:
  // At most `most` planes that at least a tenth of the sampled pixels lie on, the largest first,
  // among them only those slanted enough to matter over `block` px. Disparities of 0 are unknown.
  // Coordinates from the picture's corner. Same picture, same planes.
  const std::vector<DisparityPlane>& find(const std::vector<float>& disparity, int width,
                                          int height, int block, int most);

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
