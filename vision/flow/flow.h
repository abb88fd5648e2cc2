// Finds dense optical flow between two pictures of one eye: the displacement of each pixel, px.
// SPDX-License-Identifier: Apache-2.0
//
// The method is dense inverse search, as implemented by OpenCV, with OpenCV's ultrafast preset. Source:
// Kroeger, Timofte, Dai and Van Gool, "Fast Optical Flow using Dense Inverse Search", ECCV 2016. The search
// compares patches of 8 x 8 pixels in reduced pictures, which have a quarter of the width and height. The
// flow is then validated patch by patch on the same reduced pictures. Validation takes only a fraction of the
// computing time of the search. The flow of a pixel is valid only if the patch around the pixel passes three
// tests.
// - The later picture at the displaced position matches the patch, except for a change of brightness
//   (`max_unlike`).
// - The patch has enough texture in two directions, so that the expected standard error of the flow is small
//   (`max_error_px`). On a single edge, the flow along the edge is arbitrary (aperture problem).
// - The search has converged: a further Lucas-Kanade step is short (`max_step_px`). This convergence test
//   replaces a forward-backward check, which would need the backward flow.
// The flow of all other pixels is NaN. Flow is the displacement (px) of a point between the two pictures. A
// point at pixel (u, v) of the earlier picture is at (u, v) + flow in the later picture. As long as the
// number of OpenCV's threads does not change, the same two pictures give the same flow, regardless of earlier
// calls.
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

// Limits of the three tests that make the flow of a patch valid. Brightness is in gray codes.
struct FlowOptions {
  // Maximum expected standard error of the flow, px: sqrt(s^2 / (n lambda)). Here s^2 is the mean square
  // residual of the patch, but at least the variance of the noise. The patch has n pixels. The mean structure
  // tensor of the patch has two eigenvalues, and the smaller one is lambda.
  double max_error_px = 0.6;
  // Maximum ratio of two variances over the pixels of the patch. The numerator is the variance of the
  // brightness change along the flow. The denominator is the variance of the brightness.
  double max_unlike = 0.35;
  double max_step_px = 1.0;  // maximum further Lucas-Kanade step, px of the full picture
};

// Information matrix of the flow of a patch, 1/px^2. The matrix is the inverse of the least-squares
// covariance s^2 (sum g g^T)^-1, where g is the brightness gradient. The covariance is large along an edge
// and small across the edge. All entries of the matrix are 0 where the flow is unknown.
struct FlowCertainty {
  float xx = 0, xy = 0, yy = 0;

  // Returns the squared Mahalanobis distance between this patch's flow and a flow that differs by `off` (px).
  float surprise(const Eigen::Vector2f& off) const {
    return xx * off.x() * off.x() + 2 * xy * off.x() * off.y() + yy * off.y() * off.y();
  }
};

struct FlowImage {
  static constexpr int kCell_px = 4;  // side of a cell

  FrameInfo before, after;
  int width = 0, height = 0;
  // Displacement of each pixel to the right and down. Where the displacement is unknown, both components are
  // NaN.
  std::vector<Eigen::Vector2f> flow_px;
  // The picture has `cells_across` x `cells_down` cells. `certainty` has one element per cell, row by row
  // from the top. The last cell of a row or column also contains the remaining pixels at the right or lower
  // edge. In each cell, the flow is known for all pixels or for no pixel.
  int cells_across = 0, cells_down = 0;
  std::vector<FlowCertainty> certainty;

  const Eigen::Vector2f& at(int u, int v) const {
    return flow_px[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(u)];
  }
  bool known(int u, int v) const { return !std::isnan(at(u, v).x()); }
  double seconds_between() const { return seconds(between(after.exposure, before.exposure)); }
};

// Finds dense flow. Not thread-safe. The flow depends slightly on the number of threads that OpenCV uses
// (opencv_threads.h).
class FlowFinder {
 public:
  explicit FlowFinder(const FlowOptions& options = {});
  ~FlowFinder();
  FlowFinder(FlowFinder&&) noexcept;
  FlowFinder& operator=(FlowFinder&&) noexcept;

  // Finds the flow from `before` to `after`. Reuses the memory of `flow`; after an error, the contents of
  // `flow` are undefined. If `before` is the picture that was `after` in the previous call, set `continued`
  // to true. The gray picture from the previous call can then be reused, which saves time and does not change
  // the flow. Errors:
  // - an empty or truncated picture.
  // - a picture whose width or height is outside the range of 64 to 8192 pixels.
  // - pictures of different sizes, or pictures that do not have the size given in the camera model.
  // - a camera model without focal length, or two different camera models.
  // - an exposure of `after` that is not later than the exposure of `before`, because the clock jumped back
  //   or the same picture came twice.
  // - options that are not greater than 0.
  Result<void> find(const Image& before, const FrameInfo& info_before, const Image& after,
                    const FrameInfo& info_after, FlowImage& flow, bool continued = false);
  Result<void> find(const GreyPicture& before, const FrameInfo& info_before,
                    const GreyPicture& after, const FrameInfo& info_after, FlowImage& flow);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
