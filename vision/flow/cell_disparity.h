// Median disparity around places of a depth image. Internal to vision/flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "vision/depth/depth.h"

namespace kaz::vision {

// Of the 4 x 4 pixels around each place, px, moved into the image: the median of the known disparities, the
// upper one of an even number; 0 if fewer than 6 are known. The image has at least 4 pixels a side.
void median_disparities(const DepthImage& depth, std::span<const Eigen::Vector2i> places,
                        float* to);

}  // namespace kaz::vision
