// Computes the median disparity around given pixels of a depth image. Internal to vision/flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "vision/depth/depth.h"

namespace kaz::vision {

// Writes one disparity (px) to `to` for each pixel of `depth` in `places`. The disparity is the median of the
// known disparities in the block of 4 x 4 pixels around the pixel. If the number of known disparities is
// even, the larger of the two middle disparities is written. If fewer than 6 disparities of the block are
// known, 0 is written. A block that would cross the border of the image is moved into the image. `depth` must
// be at least 4 pixels wide and high.
void median_disparities(const DepthImage& depth, std::span<const Eigen::Vector2i> places,
                        float* to);

}  // namespace kaz::vision
