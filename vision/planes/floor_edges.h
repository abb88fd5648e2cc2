// The floor's edges at the precision of a pixel: where the picture has them, near where depth does.
// SPDX-License-Identifier: Apache-2.0
//
// Block matching shifts an edge between near and far by up to half a block, and where a box stands
// on the floor depth has a bend that it sees only some pixels further up. What lies as far as that
// from the border of the floor's segments is taken as undecided, and decided anew by the picture:
// floor and all else grow into it from both sides, first where the picture changes least, and meet
// where it changes most (F. Meyer, "Color image segmentation", IPA 1992; cv::watershed). Holes in
// the depth of a floor, narrower than twice that, are closed.
//
// Where the floor and what stands on it look alike, and at a shadow's edge that near, the border
// goes wrong by `reach_px` at most. What has depth on fewer than twice that across is lost.
#pragma once

#include <memory>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision {

struct FloorEdgeOptions {
  int reach_px = 8;  // half a block of depth, and one; 1..64
  // Segments whose middle is farther from the plane of the largest are no floor here: a low step.
  double step_m = 0.01;
};

class FloorEdges {
 public:
  explicit FloorEdges(const FloorEdgeOptions& options = {});
  ~FloorEdges();
  FloorEdges(FloorEdges&&) noexcept;
  FloorEdges& operator=(FloorEdges&&) noexcept;

  // `left`: the rectified picture that planes were found in. Changes `planes.label`, not what is
  // known of the segments: pixels that become floor belong to the largest segment of it. Without
  // floor nothing happens. Errors, after which nothing is changed: a picture of another size or cut
  // short; options out of range.
  Result<void> sharpen(const Image& left, PlaneSegments& planes);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
