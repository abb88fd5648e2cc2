// Median disparity around places of a depth image. Internal to vision/flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "vision/depth/depth.h"

namespace kaz::vision {

// Writes one disparity (px) to `to` for each place (px in the depth image). It is the median of the known
// disparities in the 4 x 4 pixels around it. With an even number it is the upper median. If fewer than 6 are
// known, it is 0. Blocks that would cross the border are moved into the image, which must have at least 4
// pixels a side.
void median_disparities(const DepthImage& depth, std::span<const Eigen::Vector2i> places,
                        float* to);

}  // namespace kaz::vision
