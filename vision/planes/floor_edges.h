// Refines the edges of the floor's segments to pixel precision on the picture.
// SPDX-License-Identifier: Apache-2.0
//
// Block matching shifts an edge between near and far by up to half a block. Where a box stands on the floor,
// depth has a bend that is detected only some pixels higher. Pixels within `reach_px` of the border of the
// floor's segments are therefore undecided, and a marker-controlled watershed labels them. Floor and
// non-floor grow into this band from both sides, first where the color gradient is small. They meet where it
// is largest. Sources: F. Meyer, "Color image segmentation", IPA 1992; cv::watershed. Holes in the floor
// narrower than 2 reach_px are closed, unless depth shows an object there. Its pixels become a marker if they
// stand higher above the floor than the depth error. They must be farther than 3/4 reach_px from the floor's
// pixels.
//
// Limitations: the border is wrong by up to `reach_px` where floor and object have the same color, or near
// the edge of a shadow. Objects less than 1.5 reach_px wide are lost. This width includes the half block by
// which matching widens them.
#pragma once

#include <memory>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"
#include "vision/image/frame.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision {

struct FloorEdgeOptions {
  int reach_px = 8;  // half a block of depth, plus one; 1..64
  // Maximum distance (m) of the middle of a floor segment from the plane of the largest one. Beyond it, a
  // segment is not treated as floor, for example a low step.
  double step_m = 0.01;
};

class FloorEdges {
 public:
  explicit FloorEdges(const FloorEdgeOptions& options = {});
  ~FloorEdges();
  FloorEdges(FloorEdges&&) noexcept;
  FloorEdges& operator=(FloorEdges&&) noexcept;

  // Refines `planes.label`, not the segments. Pixels that become floor get the label of the largest floor
  // segment. `left` is the rectified picture and `depth` the depth image in which the planes were found.
  // Without `depth`, objects less than 2 reach_px wide are lost. Does nothing without floor. Errors, which
  // leave `planes` unchanged: a picture or depth image of another size or truncated; options out of range.
  Result<void> sharpen(const Image& left, PlaneSegments& planes, const DepthImage* depth = nullptr);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
