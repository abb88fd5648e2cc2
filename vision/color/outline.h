// Finds the outline of a region with subpixel precision.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "vision/image/frame.h"
#include "vision/image/regions.h"

namespace kaz::vision {

// Point where the outline crosses the line between two adjacent pixels, of which one is inside the region.
struct OutlinePoint {
  double u, v;  // px; midway between both pixels, or refined
  int inside_u, inside_v;
  // Step from the inner to the outer pixel; one of both is 0, the other 1 or -1.
  int step_u, step_v;
};

// Returns the outermost crossings of each row and each column of the region, so outlines of holes are not
// included. Where the region touches the edge of the picture, there is no crossing.
std::vector<OutlinePoint> outline_of(const Region& region, int width, int height);

// Moves a point along its line to the transition between the colors of region and background, and returns it.
// The position is computed from the share of the region's color in the mixed pixels. Returns the point
// unchanged if it is too close to the picture's edge or the contrast is too low.
OutlinePoint refined(const Image& image, const OutlinePoint& point);

}  // namespace kaz::vision
