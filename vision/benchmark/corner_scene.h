// Depth image for benchmarks of plane finders.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vision/depth/stereo_testing.h"

namespace kaz::vision {

// Returns the depth image of a floor, a wall, and the front and top of a box, with 0.2 px of disparity noise.
inline DepthImage corner_scene(int width) {
  std::vector<int> patch;
  DepthImage image = test_corner().truth(test_camera(width, width * 3 / 4), patch);
  for (std::size_t i = 0; i < image.disparity_px.size(); ++i) {
    float& d = image.disparity_px[i];
    if (d > 0) d += static_cast<float>(0.2 * keyed_normal(1, 2, i));
  }
  return image;
}

}  // namespace kaz::vision
