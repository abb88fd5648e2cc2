// First outlines of a ball from a region of its color.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "vision/color/ball_outline.h"
#include "vision/color/outline.h"

namespace kaz::vision {

inline constexpr double kMinOutlineRadius_px = 2, kMaxOval = 0.15;

// Returns up to three outlines. The first is the circle through three outline points that agrees best with
// the other points; it suits a ball that is hidden in part. The others are the ellipse with the region's
// second moments, and the circle around its bounding box. `points`: outline_of() of the region.
std::vector<BallOutline> outline_hypotheses(const Region& region,
                                            std::span<const OutlinePoint> points);

}  // namespace kaz::vision
