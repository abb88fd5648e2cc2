// Refines the edges of the floor's segments to pixel precision on the picture.
// SPDX-License-Identifier: Apache-2.0
//
// Block matching shifts an edge between near and far by up to half a block, and where a box stands
// on the floor depth has a bend that it detects only some pixels further up. Pixels within `reach_px` of
// the border of the floor's segments are therefore undecided, and a marker-controlled watershed labels
// them: floor and non-floor grow into the band from both sides, first where the colour gradient is small,
// and meet where it is largest (F. Meyer, "Color image segmentation", IPA 1992; cv::watershed). Holes in
// the floor narrower than 2 reach_px are closed, unless depth shows that something stands there: its pixels
// farther than 3/4 reach_px from the floor, higher above it than depth errs, are a marker as well.
//
// Limitations: where the floor and an object on it have the same colour, or a shadow's edge is near, the
// border is wrong by up to `reach_px`. Objects are lost that are, with the half block by which
// matching widens them, less than 1.5 reach_px wide.
#pragma once

#include <memory>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"
#include "vision/image/frame.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision {

struct FloorEdgeOptions {
  int reach_px = 8;  // half a block of depth, and one; 1..64
  // m. Segments whose middle is farther than this from the plane of the largest floor segment are not
  // treated as floor: a low step.
  double step_m = 0.01;
};

class FloorEdges {
 public:
  explicit FloorEdges(const FloorEdgeOptions& options = {});
  ~FloorEdges();
  FloorEdges(FloorEdges&&) noexcept;
  FloorEdges& operator=(FloorEdges&&) noexcept;

  // `left`: the rectified picture in which the planes were found; `depth`: the depth image in which they were
  // found; without it, objects less than 2 reach_px wide are lost. Changes `planes.label`, not the segments:
  // pixels that become floor get the label of the largest floor segment. Does nothing without floor.
  // Errors, after which nothing is changed: a picture or depth of another size or cut short; options out of
  // range.
  Result<void> sharpen(const Image& left, PlaneSegments& planes, const DepthImage* depth = nullptr);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
