// The depth image that plane finders are timed on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vision/depth/stereo_testing.h"

namespace kaz::vision {

// Floor, wall, and a box's front and top, with 0.2 px of noise.
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
