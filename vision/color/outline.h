// The outline of a region, to fractions of a pixel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "vision/image/frame.h"
#include "vision/image/regions.h"

namespace kaz::vision {

// Crossing of the outline with the line between two pixels, one inside, one outside.
struct OutlinePoint {
  double u, v;  // px, midway between the two, or refined
  int inside_u, inside_v;
  int step_u, step_v;  // from the inner to the outer pixel: one is 0, the other 1 or -1
};

// Returns the outermost crossings of each row and each column, so holes do not count. There are no crossings
// where the region touches the edge of the picture.
std::vector<OutlinePoint> outline_of(const Region& region, int width, int height);

// Moves a point along its line to the transition between the colors of region and background. Mixed pixels
// count by their share. Returns it unchanged if there is no room or no contrast.
OutlinePoint refined(const Image& image, const OutlinePoint& point);

}  // namespace kaz::vision
