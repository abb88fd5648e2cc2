// Dense optical flow between two pictures of one eye: the displacement of each pixel, px.
// SPDX-License-Identifier: Apache-2.0
//
// Dense inverse search (T. Kroeger, R. Timofte, D. Dai, L. Van Gool, "Fast Optical Flow using Dense Inverse
// Search", ECCV 2016) as implemented by OpenCV, with its ultrafast preset. The search compares patches of 8 x
// 8 pixels in pictures reduced to a quarter in width and height. The flow is then validated patch by patch on
// the same reduced pictures. Validation costs a fraction of the search. The flow of a pixel is valid only if
// the patch around it passes three tests.
// - The patch matches at the displaced position, up to a change of brightness (`max_unlike`).
// - The patch has enough texture in two directions for a small expected standard error (`max_error_px`).
//   Otherwise the flow may slide along an edge (aperture problem).
// - The search has converged: a further Lucas-Kanade step is short (`max_step_px`). This test replaces a
//   forward-backward check, which would need the backward flow.
// Other pixels are NaN. Flow is the displacement in px from the earlier picture to the later picture, stored
// by pixel of the earlier picture. A point at (u, v) moves to (u, v) + flow. The same two pictures give the
// same flow: the only state is reused memory.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"  // GreyPicture
#include "vision/image/frame.h"

namespace kaz::vision {

// Limits for patches of the reduced pictures, in gray codes.
struct FlowOptions {
  // Maximum expected standard error, px: sqrt(s^2 / (n lambda)). Here s^2 is the mean square residual (at
  // least the noise) and n the number of pixels. The smaller eigenvalue of the mean structure tensor is
  // called lambda.
  double max_error_px = 0.6;
  // Maximum ratio of the residual variance at the displaced position to the brightness variance of the patch.
  double max_unlike = 0.35;
  double max_step_px = 1.0;  // maximum further Lucas-Kanade step, px of the full picture
};

// Information matrix of the flow of a patch, 1/px^2. It is the inverse of the least-squares covariance s^2
// (sum g g^T)^-1, where g is the gradient. The covariance is large along an edge and small across it. All
// entries are 0 where the flow is unknown.
struct FlowCertainty {
  float xx = 0, xy = 0, yy = 0;

  // Returns the squared Mahalanobis distance of the deviation `off` (px).
  float surprise(const Eigen::Vector2f& off) const {
    return xx * off.x() * off.x() + 2 * xy * off.x() * off.y() + yy * off.y() * off.y();
  }
};

struct FlowImage {
  static constexpr int kCell_px = 4;  // side of a cell

  FrameInfo before, after;
  int width = 0, height = 0;
  std::vector<Eigen::Vector2f> flow_px;  // (right, down); NaN in both where unknown
  // One entry per cell, rows from the top. The last cell of a row or column includes the remaining pixels at
  // the right or lower edge. The pixels of a cell are either all known or all unknown.
  int cells_across = 0, cells_down = 0;
  std::vector<FlowCertainty> certainty;

  const Eigen::Vector2f& at(int u, int v) const {
    return flow_px[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(u)];
  }
  bool known(int u, int v) const { return !std::isnan(at(u, v).x()); }
  double seconds_between() const { return seconds(between(after.exposure, before.exposure)); }
};

// Finds dense flow. Not thread-safe. OpenCV may distribute the work over its own threads, which changes the
// flow slightly (opencv_threads.h).
class FlowFinder {
 public:
  explicit FlowFinder(const FlowOptions& options = {});
  ~FlowFinder();
  FlowFinder(FlowFinder&&) noexcept;
  FlowFinder& operator=(FlowFinder&&) noexcept;

  // Reuses the memory of `flow`, whose contents are undefined after an error. `continued` states that
  // `before` was the picture `after` of the previous call. If the previous call succeeded, its converted
  // picture is then reused; the result is the same. Errors:
  // - a picture that is empty, truncated, under 64 or over 8192 pixels a side.
  // - pictures that differ in size, or from the size of the camera model.
  // - a camera model without focal length, or two different camera models.
  // - an exposure that is not later than the previous one: the clock jumped back, or the same picture came
  //   twice.
  // - options that are not above 0.
  Result<void> find(const Image& before, const FrameInfo& info_before, const Image& after,
                    const FrameInfo& info_after, FlowImage& flow, bool continued = false);
  Result<void> find(const GreyPicture& before, const FrameInfo& info_before,
                    const GreyPicture& after, const FrameInfo& info_after, FlowImage& flow);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
