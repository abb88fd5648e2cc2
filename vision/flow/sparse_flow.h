// Flow of single points: corners, followed from one picture to the next and back.
// SPDX-License-Identifier: Apache-2.0
//
// Corners: J. Shi, C. Tomasi, "Good Features to Track", CVPR 1994. Followed by Lucas and Kanade's
// method in pyramids of pictures (J.-Y. Bouguet, 2000), both OpenCV's. Finer than dense flow, for
// fewer points: 0.1 px where there is a corner. px, pixel centres at integers.
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
  double min_quality = 0.01;     // of a corner, share of the best one's
  double min_separation_px = 8;  // from corner to corner
  int window_px = 15;            // side of what is compared; odd, 5..51
  int levels = 3;                // halved pictures beside the full one, 0..8
  double max_return_px = 0.5;    // how far the way back may end from where it began
};

struct FlowPoint {
  enum class Status {
    followed,
    lost,          // left the picture, or nothing like it is there
    inconsistent,  // the way back ends elsewhere
  };
  Eigen::Vector2f before, after;  // px; `after` means nothing where lost
  Status status = Status::lost;
  float return_px = 0;  // how far from `before` the way back ended; 0 where lost

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

  // The earlier picture's corners, best first. Errors as those of FlowFinder::find(), and options
  // out of range. A picture without corners gives no points.
  Result<void> find(const Image& before, const FrameInfo& info_before, const Image& after,
                    const FrameInfo& info_after, FlowPoints& flow);
  Result<void> find(const GreyPicture& before, const FrameInfo& info_before,
                    const GreyPicture& after, const FrameInfo& info_after, FlowPoints& flow);
  // These points, in their order; one outside of the picture is lost.
  Result<void> follow(const GreyPicture& before, const FrameInfo& info_before,
                      const GreyPicture& after, const FrameInfo& info_after,
                      const std::vector<Eigen::Vector2f>& points, FlowPoints& flow);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
