// Detects independently moving objects: optical flow that ego-motion does not explain.
// SPDX-License-Identifier: Apache-2.0
//
// For a static point at ray r = (x, y, 1) and inverse depth w, the ego-motion (R, t) between the two
// exposures predicts the flow to pi(R r + w t). R and t come from the joint angles at both exposures
// and are refined on the flow (ego_motion.h). The inverse depth of a cell is an interval:
//   1. from stereo, within one pixel of disparity, where the depth image is valid;
//   2. else from the floor plane: the point is on the floor, up to `highest_on_floor_m` above it;
//   3. else (above the horizon, far away) anything in [0, 1 / nearest_elsewhere_m]: only the rotation
//      constrains it.
// An interval of w maps to a line segment of flows; the residual is the distance vector from that segment.
// A cell is moving if its residual exceeds the error bounds of flow and pose and is unlikely under the
// flow's own covariance (large along an edge). Flow is smooth and bleeds over object borders, so each
// candidate cell is checked on the images: if warping by ego-motion matches better than the measured flow,
// the cell is static. Connected moving cells form a region if for a part of them ego-motion does not match
// at all; the region's flow is then re-estimated as one translation of all its pixels.
// Limitation: motion along the epipolar line is not detected where the depth is unknown.
//
// Frames: pixels of the earlier image; optical and foot frames as in frame.h. The supporting foot is at
// rest and the same at both exposures. Units: px, m, s.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"
#include "vision/flow/ego_motion.h"
#include "vision/flow/ego_motion_rows.h"
#include "vision/flow/flow.h"
#include "vision/flow/motion_images.h"
#include "vision/image/regions.h"

namespace kaz::vision {

struct IndependentMotionOptions {
  double flow_error_px = 1.0;  // error bound of the flow
  // Regions that reach the lowest tenth of the image, have no stereo depth and whose flow is explained by
  // a static object at least this near are discarded: the robot's own shoulders, too near for stereo.
  double nearest_body_m = 0.05;
  // Standard deviations of the ego-motion from the postures (quantisation and noise of the potentiometers,
  // backlash of 0.4 degrees, sway), and the largest corrections accepted.
  double posture_error_rad = 0.005, max_posture_error_rad = 0.03;
  double posture_error_m = 0.002, max_posture_error_m = 0.01;
  double min_surprise = 3;   // Mahalanobis distance of a residual under the flow's covariance
  int min_cells = 4;         // of a region
  int min_proven_cells = 3;  // of those, cells that ego-motion does not match at all
  double min_proven = 0.2;   // share of the region's cells
  double highest_on_floor_m = 0.10;
  double nearest_elsewhere_m = 0.5;  // where neither stereo nor floor constrains the depth
};

// May exceed the object by up to half a patch of the flow (14 px) where its surroundings lack texture.
struct MovingRegion {
  int pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // bounding box, px, inclusive
  double center_u = 0, center_v = 0;             // px
  Eigen::Vector2d velocity_px_s{0, 0};           // mean residual over time, ego-motion removed
  // Foot frame, where stereo depth is known: the point at the centre (m) and its velocity (m/s). The flow
  // of one camera does not measure the component along the ray: the motion is assumed horizontal (a rolling
  // object), or, if the ray descends by less than 10 degrees, perpendicular to the ray.
  std::optional<Eigen::Vector3d> position_m, velocity_m_s;
  // 0..1: share of its cells that ego-motion does not match at all.
  double confidence = 0;
};

struct MovingRegions {
  enum class Depth : std::uint8_t { none, stereo, floor, far };

  FrameInfo before, after;
  // Correction of the ego-motion from the postures, later optical frame.
  Eigen::Vector3d turn_error_rad{0, 0, 0}, shift_error_m{0, 0, 0};
  double spread_px = 0;  // robust standard deviation of the residuals, each axis
  // One entry per cell of the flow image.
  int cells_across = 0, cells_down = 0;
  std::vector<Eigen::Vector2f> residual_px;  // NaN where flow is unknown
  std::vector<Depth> depth;           // source of the depth interval; none where flow is unknown
  std::vector<std::uint8_t> label;    // number of the region, from 1; 0: static or unknown
  std::vector<MovingRegion> regions;  // largest first, 255 at most
};

class IndependentMotionDetector {
 public:
  explicit IndependentMotionDetector(const IndependentMotionOptions& options = {})
      : options_(options) {}

  // `before`, `after`: the images of the flow. `depth`: of the earlier or the later one, or null. Reuses
  // the memory of `moving`, which is undefined after an error. Errors: posture unknown at one of the
  // exposures; a jump of the camera (over 5 m/s or 20 rad/s: change of the supporting foot); a depth image
  // of another exposure or size; images of another size; an empty flow image.
  Result<void> find(const FlowImage& flow, const Image& before, const Image& after,
                    const DepthImage* depth, MovingRegions& moving);
  Result<void> find(const FlowImage& flow, const GreyPicture& before, const GreyPicture& after,
                    const DepthImage* depth, MovingRegions& moving);

 private:
  struct Picture {
    int width, height, channels;
    std::span<const std::uint8_t> bytes;
  };
  Result<void> find(const FlowImage& flow, const Picture& before, const Picture& after,
                    const DepthImage* depth, MovingRegions& moving);
  FlowSample sample(std::size_t k) const;
  void find_disparities(const FlowImage& flow, const DepthImage& depth, bool later, int y, int v);
  void find_candidates(const FlowImage& flow, const DepthImage* depth, MovingRegions& moving);
  void verify_on_images(const FlowImage& flow, const GreyReader& before, const GreyReader& after,
                        const MovingRegions& moving);
  void collect_regions(const FlowImage& flow, const GreyReader& before, const GreyReader& after,
                       MovingRegions& moving);
  bool is_own_body(const FlowImage& flow, const Region& cells, double allowed_px) const;
  void locate(const FlowImage& flow, MovingRegion& region, const Region& cells) const;

  IndependentMotionOptions options_;
  FlowSamples samples_;
  FlowResiduals residuals_;
  std::vector<Eigen::Vector2i> places_;  // of a row's samples in the depth image
  std::vector<std::uint8_t> inside_;
  std::vector<float> disparity_;      // there, px
  std::vector<int> columns_;          // centres of the cells of a row, px
  std::vector<std::size_t> cell_;     // of each sample
  std::vector<int> sample_;           // by cell: number of its sample, from 1; 0: none
  Eigen::Isometry3d later_;           // later optical frame from the earlier one, corrected
  std::vector<float> inverse_depth_;  // by cell, from stereo; 0 where unknown
  Mask candidates_;                   // by cell
  std::vector<float> grey_[2];        // codes of both pictures
  std::vector<std::uint8_t> proven_;  // by cell: ego-motion does not match at all
  std::vector<Eigen::Vector2i> corners_;
  RegionFinder finder_;
};

}  // namespace kaz::vision
