// Uses the colors of the picture to refine the edges of the floor's segments to pixel precision.
// SPDX-License-Identifier: Apache-2.0
//
// Block matching shifts the edge between a near and a far surface by up to half a block. Where a box stands
// on the floor, the depth image has no step but only a bend. The bend is detected some pixels too high. The
// border of the floor's segments is therefore inaccurate, and pixels within `reach_px` of the border are
// undecided. A marker-controlled watershed labels the undecided pixels. Floor and non-floor grow into the
// undecided band from both sides, first where the color gradient is small. Floor and non-floor meet where the
// gradient is largest. Sources: F. Meyer, "Color image segmentation", IPA 1992; cv::watershed. A hole in the
// floor is labeled as floor if the hole is narrower than `2 * reach_px` and the depth image shows no object
// in it. A pixel of an object in a hole becomes part of a marker if two conditions are met. The pixel's
// height above the floor exceeds both 15 mm and the depth error. The pixel's distance from the floor's pixels
// exceeds 3/4 of `reach_px`.
//
// Limitations: the border is wrong by up to `reach_px` where floor and object have the same color, or near
// the edge of a shadow. If an object is narrower than `1.5 * reach_px` in the depth image, the object is
// labeled as floor. In the depth image, objects are wider than in the picture, because block matching widens
// objects by half a block.
#pragma once

#include <memory>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"
#include "vision/image/frame.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision {

struct FloorEdgeOptions {
  int reach_px = 8;  // half a block of stereo matching plus one pixel; 1..64
  // Maximum distance (m) between the middle of a floor segment and the plane of the largest floor segment.
  // Segments at a larger distance, such as a low step, are not treated as floor.
  double step_m = 0.01;
};

class FloorEdges {
 public:
  explicit FloorEdges(const FloorEdgeOptions& options = {});
  ~FloorEdges();
  FloorEdges(FloorEdges&&) noexcept;
  FloorEdges& operator=(FloorEdges&&) noexcept;

  // Refines `planes.label`, not the segments. Pixels that become floor get the label of the largest floor
  // segment. `left` is the rectified left picture. `depth` is the depth image in which the planes were
  // found. Without `depth`, objects narrower than `2 * reach_px` are labeled as floor. Does nothing if there
  // is no floor segment. Errors: the picture or the depth image is truncated, or differs in size from
  // `planes`; `reach_px` is out of range. An error leaves `planes` unchanged.
  Result<void> sharpen(const Image& left, PlaneSegments& planes, const DepthImage* depth = nullptr);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
