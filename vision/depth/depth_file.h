// Depth as files of other programs: a picture of 16 bits, and a cloud of points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vision/depth/depth.h"

namespace kaz::vision {

// The content of a grey PNG of 16 bits: depth along the optical axis in mm, rounded, 0 where there
// is none and beyond 65.535 m; as RGB-D data sets and ROS (REP 118) have it. Errors: an empty depth
// image.
Result<std::vector<std::uint8_t>> depth_png(const DepthImage& depth);

// The content of a binary little-endian PLY: x y z in m as floats, red green blue as bytes. Points
// that are not known are left out; `colors` is the left picture. Errors: sizes that differ.
Result<std::vector<std::uint8_t>> points_ply(const PointCloud& cloud, const Image& colors);

}  // namespace kaz::vision
