// Finds the outline of a region with subpixel precision.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "vision/image/frame.h"
#include "vision/image/regions.h"

namespace kaz::vision {

// Point where the outline crosses the line between two adjacent pixels: one pixel inside the region and one
// pixel outside.
struct OutlinePoint {
  double u, v;  // position of the point, px: midway between both pixels, or refined
  int inside_u, inside_v;
  // Step from the inner pixel to the outer pixel. One of step_u and step_v is 0, the other is 1 or -1.
  int step_u, step_v;
};

// Returns the outermost points at which each row and each column crosses the outline. Outlines of holes are
// therefore not included. Where the region touches the edge of the picture, there is no point.
std::vector<OutlinePoint> outline_of(const Region& region, int width, int height);

// Moves a point along the line between both pixels to the transition between the colors of region and
// background. Returns the moved point. The transition is computed from the share of the region's color in the
// mixed pixels. Returns the point unchanged if the point is too close to the picture's edge, or the contrast
// is too low.
OutlinePoint refined(const Image& image, const OutlinePoint& point);

}  // namespace kaz::vision
