// Computes the median disparity around given pixels of a depth image. Internal to vision/flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "vision/depth/depth.h"

namespace kaz::vision {

// Writes one disparity (px) to `to` for each place (px in the depth image). The value is the median of the
// known disparities in the block of 4 x 4 pixels around the place. If the number of known disparities is
// even, the upper median is written. If the number is less than 6, 0 is written. Blocks that would cross the
// border are moved into the image. The image must have at least 4 pixels a side.
void median_disparities(const DepthImage& depth, std::span<const Eigen::Vector2i> places,
                        float* to);

}  // namespace kaz::vision
