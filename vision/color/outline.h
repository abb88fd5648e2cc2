// Finds the outline of a region with subpixel precision.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vision/image/frame.h"
#include "vision/image/regions.h"

namespace kaz::vision {

// Point of the outline, between an inner pixel and an outer pixel. The inner pixel is inside the region. The
// outer pixel is adjacent to the inner pixel and outside the region.
struct OutlinePoint {
  // Position of the point, px: midway between the inner and the outer pixel, or the result of refined().
  double u, v;
  int inside_u, inside_v;
  // Step from the inner pixel to the outer pixel. One of step_u and step_v is 0, the other is 1 or -1.
  int step_u, step_v;
};

// Returns the first and the last outline point in each row and in each column of the region. The outline of a
// hole therefore gives no points. Where the region touches the edge of the picture, there is no point.
std::vector<OutlinePoint> outline_of(const Region& region, int width, int height);

// Moves a point along the line from the inner pixel to the outer pixel. Returns the moved point, where the
// region's color changes to the background's color. The inner and the outer pixel may be mixtures of these
// colors. The new position is computed from the share of the region's color in these two pixels.
// Returns the point unchanged if the point is too close to the picture's edge, or the contrast is too low.
OutlinePoint refined(const Image& image, const OutlinePoint& point);

}  // namespace kaz::vision
