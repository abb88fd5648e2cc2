// Dense optical flow between two pictures of one eye: the displacement of each pixel, px.
// SPDX-License-Identifier: Apache-2.0
//
// Dense inverse search (T. Kroeger, R. Timofte, D. Dai, L. Van Gool, "Fast Optical Flow using Dense
// Inverse Search", ECCV 2016) as implemented by OpenCV, with its ultrafast preset: patches of 8 x 8
// pixels of pictures a quarter as wide and high. Its result is validated on those small pictures, patch by
// patch, at a fraction of its cost. The flow of a pixel is valid only if the patch around it
// - matches at the displaced position, up to a change of brightness (`max_unlike`),
// - has enough texture in two directions for the expected standard error (`max_error_px`; else the patch
//   may slide along an edge: aperture problem), and
// - has converged: a further Lucas-Kanade step stays short (`max_step_px`). This replaces a
//   forward-backward check, without computing the backward flow.
// Other pixels are NaN. Flow is in px from the earlier picture to the later, by pixel of the earlier
// one: what is at (u, v) before is at (u, v) + flow after. Without state except reused
// memory: the same two pictures give the same flow.
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

// Of the small pictures' patches; codes are those of the grey picture.
struct FlowOptions {
  // Maximum expected standard error, px: sqrt(s^2 / (n lambda)), with the mean square residual s^2 (not
  // below the noise), n pixels and the smaller eigenvalue lambda of the mean structure tensor.
  double max_error_px = 0.6;
  // Maximum ratio of the residual's variance after the flow to the patch's variance of brightness.
  double max_unlike = 0.35;
  double max_step_px = 1.0;  // length of the further Lucas-Kanade step, px of the full picture
};

// Information matrix of a patch's flow, 1/px^2: the inverse of the least-squares covariance
// s^2 (sum g g^T)^-1, which is large along an edge and small across it. All 0 where the flow is unknown.
struct FlowCertainty {
  float xx = 0, xy = 0, yy = 0;

  // Squared Mahalanobis distance of the deviation `off`, px.
  float surprise(const Eigen::Vector2f& off) const {
    return xx * off.x() * off.x() + 2 * xy * off.x() * off.y() + yy * off.y() * off.y();
  }
};

struct FlowImage {
  static constexpr int kCell_px = 4;  // side of a cell

  FrameInfo before, after;
  int width = 0, height = 0;
  std::vector<Eigen::Vector2f> flow_px;  // (right, down); NaN in both where unknown
  // By cell, rows from the top; the remainder of the picture at its right and lower edge belongs to
  // the last cells. All pixels of a cell are known, or none.
  int cells_across = 0, cells_down = 0;
  std::vector<FlowCertainty> certainty;

  const Eigen::Vector2f& at(int u, int v) const {
    return flow_px[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(u)];
  }
  bool known(int u, int v) const { return !std::isnan(at(u, v).x()); }
  double seconds_between() const { return seconds(between(after.exposure, before.exposure)); }
};

// OpenCV may share the work between threads, with slightly other flow: opencv_threads.h.
class FlowFinder {
 public:
  explicit FlowFinder(const FlowOptions& options = {});
  ~FlowFinder();
  FlowFinder(FlowFinder&&) noexcept;
  FlowFinder& operator=(FlowFinder&&) noexcept;

  // Reuses the memory of `flow`, whose contents are undefined after an error. Errors: pictures that
  // are empty, cut short, under 64 or over 8192 pixels a side, of different size or not of the
  // camera model's; a camera model without focal length or that differs between the two; an
  // exposure that is not after the one before (the clock jumped back, or a picture twice).
  // `continued`: `before` is the picture that was `after` in the previous call, whose conversion is used
  // again if that call succeeded; the result is the same.
  Result<void> find(const Image& before, const FrameInfo& info_before, const Image& after,
                    const FrameInfo& info_after, FlowImage& flow, bool continued = false);
  Result<void> find(const GreyPicture& before, const FrameInfo& info_before,
                    const GreyPicture& after, const FrameInfo& info_after, FlowImage& flow);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
