// Sparse optical flow: tracks corners from one picture to the next picture and back.
// SPDX-License-Identifier: Apache-2.0
//
// Corners: J. Shi, C. Tomasi, "Good Features to Track", CVPR 1994. Tracking: the pyramidal Lucas-Kanade
// method (J.-Y. Bouguet, 2000). OpenCV implements both. Sparse flow has fewer points than dense flow, but is
// more accurate: the error at corners is about 0.1 px. Units: px, pixel centers at integers.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"  // GreyPicture
#include "vision/image/frame.h"

namespace kaz::vision {

struct SparseFlowOptions {
  int max_points = 200;
  double min_quality = 0.01;     // minimum corner quality, as a share of the best corner's quality
  double min_separation_px = 8;  // minimum distance between corners
  int window_px = 15;            // side of the window that is compared; odd, 5..51
  int levels = 3;                // pyramid levels above the full picture, 0..8
  double max_return_px = 0.5;    // maximum forward-backward error
};

struct FlowPoint {
  enum class Status {
    followed,
    lost,          // the point left the picture, or no match was found
    inconsistent,  // the forward-backward error is too large
  };
  Eigen::Vector2f before, after;  // px; `after` is undefined if the status is `lost`
  Status status = Status::lost;
  float return_px = 0;  // forward-backward error, px; 0 if the status is `lost`

  bool followed() const { return status == Status::followed; }
};

struct FlowPoints {
  FrameInfo before, after;
  std::vector<FlowPoint> points;
};

class SparseFlow {
 public:
  explicit SparseFlow(const SparseFlowOptions& options = {});
  ~SparseFlow();
  SparseFlow(SparseFlow&&) noexcept;
  SparseFlow& operator=(SparseFlow&&) noexcept;

  // Finds corners in the earlier picture, and tracks the corners. The points in `flow` are sorted by corner
  // quality, best first. A picture without corners gives no points. Errors: the errors of FlowFinder::find(),
  // and options out of range.
  Result<void> find(const Image& before, const FrameInfo& info_before, const Image& after,
                    const FrameInfo& info_after, FlowPoints& flow);
  Result<void> find(const GreyPicture& before, const FrameInfo& info_before,
                    const GreyPicture& after, const FrameInfo& info_after, FlowPoints& flow);
  // Tracks the given points. The points in `flow` have the order of `points`. A point outside the picture
  // gets the status `lost`. Errors: the errors of find().
  Result<void> follow(const GreyPicture& before, const FrameInfo& info_before,
                      const GreyPicture& after, const FrameInfo& info_after,
                      const std::vector<Eigen::Vector2f>& points, FlowPoints& flow);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
