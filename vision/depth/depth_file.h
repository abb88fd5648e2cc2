// Converts depth to file formats that other programs read: 16-bit PNG and PLY point cloud.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vision/depth/depth.h"

namespace kaz::vision {

// Returns the content of a 16-bit gray PNG: depth along the optical axis in mm, rounded. A pixel is 0 if the
// depth is unknown or above 65.535 m, as in RGB-D data sets and ROS (REP 118). Error: an empty depth image.
Result<std::vector<std::uint8_t>> depth_png(const DepthImage& depth);

// Returns the content of a binary little-endian PLY: each point has x, y, z in m as floats, and red, green,
// blue as bytes. Unknown points are left out. `colors` is the left picture, which gives the color of each
// point. Error: `cloud` and `colors` have different sizes.
Result<std::vector<std::uint8_t>> points_ply(const PointCloud& cloud, const Image& colors);

}  // namespace kaz::vision
