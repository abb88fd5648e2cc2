// Edges of an image near an outline, and the outline fitted to them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "vision/color/ball_outline.h"

namespace kaz::vision {

inline constexpr std::size_t kOutlineRays = 48;

// Unit vectors of the rays, which are evenly distributed.
struct RayDirection {
  double cosine, sine;
};
const std::array<RayDirection, kOutlineRays>& outline_rays();

// The strongest edge on a ray from the outline's center.
struct RayEdge {
  bool seen = false;      // false if the ray's searched part is not within the picture
  double radius = 0;      // distance from the center, px
  double step_codes = 0;  // length of the change of the color (RGB), 0 to 442
  double contrast = 0;    // the same, relative to the brightness of both sides

  bool strong() const;  // false if noise of the camera can be the reason of the edge
};
using RayEdges = std::array<RayEdge, kOutlineRays>;

// Searches each ray within `reach_px` of the outline.
RayEdges edges_near(const Image& image, const BallOutline& outline, double reach_px);

// Fits center, radius and shape to edges. A robust fit: edges that are far from the outline have no weight.
// Returns false if the edges do not determine an outline.
bool fit_to_edges(BallOutline& outline, const RayEdges& edges);

}  // namespace kaz::vision
