// Optical flow between two pictures of one eye: which way, and how far, each pixel went.
// SPDX-License-Identifier: Apache-2.0
//
// Dense inverse search (T. Kroeger, R. Timofte, D. Dai, L. Van Gool, "Fast Optical Flow using Dense
// Inverse Search", ECCV 2016) as OpenCV has it, at its fastest setting: patches of 8 x 8 pixels of
// pictures a quarter as wide and high. Its result is then validated on those small pictures, patch
// by patch, at a small share of its cost. A pixel has a flow only where the patch around it
// - is found where the flow leads, up to a change of brightness,
// - has texture in two directions that, for how well it is found, leaves but a little open (else
//   it may slide along an edge), and
// - rests there: one more step of Lucas and Kanade from the other picture's side stays short, which
//   is what flow back and forth is asked for, without a second flow.
// All else is marked. Flow is in px from the earlier picture to the later, by pixel of the earlier
// one: what is at (u, v) before is at (u, v) + flow after. No state but memory: the same two
// pictures give the same flow.
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
  // Standard error to be expected, px: that of least squares, from the mean square difference after
  // the flow (noise at least) and the smaller eigenvalue of the mean of gradient times gradient.
  double max_error_px = 0.6;
  // Mean square difference after the flow, without that of the mean, over the patch's variance.
  double max_unlike = 0.35;
  double max_step_px = 1.0;  // the further step, px of the full picture
};

// Inverse of the covariance that least squares would give a patch's flow, 1/px^2: of two errors
// along an edge and across it, the first is the larger one. All 0 where the flow is unknown.
struct FlowCertainty {
  float xx = 0, xy = 0, yy = 0;

  // Square of how many standard deviations `off` is.
  float surprise(const Eigen::Vector2f& off) const {
    return xx * off.x() * off.x() + 2 * xy * off.x() * off.y() + yy * off.y() * off.y();
  }
};

struct FlowImage {
  static constexpr int kCell_px = 4;  // side of a cell

  FrameInfo before, after;
  int width = 0, height = 0;
  std::vector<Eigen::Vector2f> flow_px;  // (right, down); NaN in both where unknown
  // By cell, rows from the top; what is left of the picture at its right and lower edge belongs to
  // the last ones. All pixels of a cell are known, or none.
  int cells_across = 0, cells_down = 0;
  std::vector<FlowCertainty> certainty;

  const Eigen::Vector2f& at(int u, int v) const {
    return flow_px[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(u)];
  }
  bool known(int u, int v) const { return !std::isnan(at(u, v).x()); }
  double seconds_between() const { return seconds(between(after.exposure, before.exposure)); }
};

// OpenCV may share the work between threads; cv::setNumThreads(1) keeps it in the caller's.
class FlowFinder {
 public:
  explicit FlowFinder(const FlowOptions& options = {});
  ~FlowFinder();
  FlowFinder(FlowFinder&&) noexcept;
  FlowFinder& operator=(FlowFinder&&) noexcept;

  // Reuses the memory of `flow`, whose contents mean nothing after an error. Errors: pictures that
  // are empty, cut short, under 64 or over 8192 pixels a side, of different size or not of the
  // camera model's; a camera model without focal length or that differs between the two; an
  // exposure that is not after the one before (the clock jumped back, or a picture twice).
  Result<void> find(const Image& before, const FrameInfo& info_before, const Image& after,
                    const FrameInfo& info_after, FlowImage& flow);
  Result<void> find(const GreyPicture& before, const FrameInfo& info_before,
                    const GreyPicture& after, const FrameInfo& info_after, FlowImage& flow);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
