// The outline of a region, to fractions of a pixel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "vision/image/frame.h"
#include "vision/image/regions.h"

namespace kaz::vision {

// Where the outline crosses the line between two pixels, one inside, one outside.
struct OutlinePoint {
  double u, v;  // px, midway between the two
  int inside_u, inside_v;
  int step_u, step_v;  // from the inner to the outer pixel: one is 0, the other 1 or -1
};

// The outermost crossings of each row and each column, so that holes do not count. Where the region
// touches the edge of the picture there is no outline.
std::vector<OutlinePoint> outline_of(const Region& region, int width, int height);

// Moves a point along its line to where the colour changes from that of the region to that of what
// is beside it: mixed pixels count by their share. The point as it was, where there is no room or
// no contrast.
OutlinePoint refined(const Image& image, const OutlinePoint& point);

}  // namespace kaz::vision
