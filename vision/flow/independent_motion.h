// What moves by itself: flow that the eye's own motion does not explain.
// SPDX-License-Identifier: Apache-2.0
//
// The posture says where the eye was at both exposures, up to its errors, which the flow of most of
// the picture puts right (ego_motion.h); so a thing at rest at a known depth has a
// known flow: with R and t from the earlier optical frame to the later one, r the ray (x, y, 1) of
// a pixel and w = 1/depth, it goes to where R r + w t points. w comes, cell by cell,
// 1. from stereo, where the depth image has it, up to a pixel of disparity;
// 2. else from the floor under the sole: what is seen stands on it, up to a stated height;
// 3. else (above the horizon, far away) it is anything from 0 to that of a stated distance: the
//    turn alone explains.
// Each is a range of w, hence a piece of a line of flows. The residual leads from there to the flow
// that was measured. It is motion where it is longer than flow and posture may be wrong by, and
// unlikely under the flow's own certainty (along an edge much is allowed). Flow is smooth and runs
// over the edges of what moves; so the pictures are asked: a cell that rest fits better than its
// flow does rests. What hangs together is a region, if in a part of it rest does not fit at all;
// its own flow is then found anew, as one for all of its pixels. A thing that moves along the line
// that its own depth would move it on goes unseen where its depth is not known.
//
// Frames: pixels of the earlier picture; optical and foot as in frame.h, the foot at rest and the
// same one at both exposures. px, m, s.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"
#include "vision/flow/ego_motion.h"
#include "vision/flow/flow.h"
#include "vision/flow/motion_images.h"
#include "vision/image/regions.h"

namespace kaz::vision {

struct IndependentMotionOptions {
  double flow_error_px = 1.0;  // residuals up to that are flow's errors
  // What reaches the lower tenth of the picture, has no depth from stereo and flows as what rests
  // this near would is left out: the robot's own shoulders, too near for stereo.
  double nearest_body_m = 0.05;
  // Of turn and way of the eye between the two exposures, as the posture has them: codes and noise
  // of the potentiometers, play of the gears (0.4 degrees), sway. Standard deviations, and what is
  // no error of the posture any more.
  double posture_error_rad = 0.005, max_posture_error_rad = 0.03;
  double posture_error_m = 0.002, max_posture_error_m = 0.01;
  double min_surprise = 3;   // standard deviations of the flow
  int min_cells = 4;         // of a region
  int min_proven_cells = 3;  // of those, where rest does not fit at all
  double min_proven = 0.2;   // share of the region's cells
  double highest_on_floor_m = 0.10;
  double nearest_elsewhere_m = 0.5;  // where neither stereo nor floor tells
};

// Larger than the thing by up to half a patch of the flow (14 px) where what is around it has too
// little texture to tell.
struct MovingRegion {
  int pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // box, px, all four inside
  double center_u = 0, center_v = 0;             // px
  Eigen::Vector2d velocity_px_s{0, 0};           // mean residual over time: without the eye's part
  // Before the foot, where stereo knows the depth: the point at the centre, m, and its velocity,
  // m/s. One eye's flow has no part along the ray: it is taken to move level, as what rolls does;
  // seen from less than 10 degrees above, across the ray instead.
  std::optional<Eigen::Vector3d> position_m, velocity_m_s;
  // 0..1: share of its cells where rest does not fit at all.
  double confidence = 0;
};

struct MovingRegions {
  enum class Depth : std::uint8_t { none, stereo, floor, far };

  FrameInfo before, after;
  // By what the posture was wrong, as most of the picture has it: later optical frame.
  Eigen::Vector3d turn_error_rad{0, 0, 0}, shift_error_m{0, 0, 0};
  double spread_px = 0;  // of the residuals of what rests: standard deviation each way
  // By cell of the flow image.
  int cells_across = 0, cells_down = 0;
  std::vector<Eigen::Vector2f> residual_px;  // NaN where flow is unknown
  std::vector<Depth> depth;                  // what explained it; none where flow is unknown
  std::vector<std::uint8_t> label;           // number of the region, from 1; 0: rests, or unknown
  std::vector<MovingRegion> regions;         // largest first, 255 at most
};

class IndependentMotionDetector {
 public:
  explicit IndependentMotionDetector(const IndependentMotionOptions& options = {})
      : options_(options) {}

  // The pictures are those that the flow is of; `depth` is of the earlier or the later one, null
  // if there is none. Reuses the memory of `moving`, which means nothing after an error. Errors: a
  // posture that is not known at both exposures (nothing can be said then); an eye that has jumped
  // (over 5 m/s or 20 rad/s: another foot supports); a depth image of neither moment or of another
  // size; pictures of another size; a flow image that is empty.
  Result<void> find(const FlowImage& flow, const Image& before, const Image& after,
                    const DepthImage* depth, MovingRegions& moving);
  Result<void> find(const FlowImage& flow, const GreyPicture& before, const GreyPicture& after,
                    const DepthImage* depth, MovingRegions& moving);

 private:
  Result<void> find(const FlowImage& flow, const GreyReader& before, const GreyReader& after,
                    const DepthImage* depth, MovingRegions& moving);
  void explain(const FlowImage& flow, const DepthImage* depth, MovingRegions& moving);
  void ask(const FlowImage& flow, const GreyReader& before, const GreyReader& after,
           const MovingRegions& moving);
  void collect(const FlowImage& flow, const GreyReader& before, const GreyReader& after,
               MovingRegions& moving);
  bool is_near(const FlowImage& flow, const Region& cells, double allowed_px) const;
  void place(const FlowImage& flow, MovingRegion& region, const Region& cells) const;

  IndependentMotionOptions options_;
  std::vector<FlowSample> sights_;
  std::vector<std::size_t> cell_;     // of each
  std::vector<int> sight_;            // by cell: number of its sight, from 1
  Eigen::Isometry3d later_;           // later optical frame from the earlier one, corrected
  std::vector<float> inverse_depth_;  // by cell, from stereo; 0 where unknown
  Mask moves_;
  std::vector<std::uint8_t> proven_;  // by cell: rest does not fit at all
  std::vector<Eigen::Vector2i> corners_;
  RegionFinder finder_;
};

}  // namespace kaz::vision
