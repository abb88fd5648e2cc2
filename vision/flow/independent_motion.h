// Detects independently moving objects: optical flow that ego-motion does not explain.
// SPDX-License-Identifier: Apache-2.0
//
// A static point has the ray r = (x, y, 1) and the inverse depth w. The ego-motion (R, t) between the two
// exposures predicts its flow to pi(R r + w t). R and t are computed from the joint angles at both exposures
// and refined with the flow (ego_motion.h). The inverse depth of a cell is an interval, which depends on what
// is known:
// 1. Where the depth image is valid, the interval is the stereo disparity plus or minus one pixel.
// 2. Elsewhere, if the ray meets the floor plane, the point is on the floor or up to `highest_on_floor_m`
//    above the floor.
// 3. Otherwise (above the horizon, or far away) the interval is [0, 1 / nearest_elsewhere_m]. Then mainly the
//    rotation determines the predicted flow.
//
// An interval of w maps to a line segment of flows. The residual is the vector from the nearest point of that
// segment to the measured flow. A cell is moving if its residual exceeds the error bounds of flow and pose.
// The residual must also be unlikely under the covariance of the flow, which is large along an edge. Flow is
// smooth and bleeds over object borders, so each candidate cell is verified on the images. A candidate cell
// is static if warping by ego-motion matches the images better than the measured flow. Connected moving cells
// form a region if ego-motion does not match the images at all in some of these cells. The flow of the region
// is then estimated again as one translation of all its pixels. Limitation: where the depth is unknown,
// motion along the epipolar line is not detected.
//
// Frames: pixels of the earlier image; optical and foot frames as in frame.h. The supporting foot must be the
// same at both exposures and must not move between them. Units: px, m, s.
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
  // Minimum depth of the robot's own shoulders. A region is dropped as a shoulder if it meets three
  // conditions. It reaches the lowest tenth of the image, has no stereo depth, and its flow fits a static
  // object at this depth or farther.
  double nearest_body_m = 0.05;
  // Standard deviations of the ego-motion computed from the postures, and the largest accepted corrections.
  // Causes of error: noise and quantization of the potentiometers, backlash of 0.4 degrees, sway.
  double posture_error_rad = 0.005, max_posture_error_rad = 0.03;
  double posture_error_m = 0.002, max_posture_error_m = 0.01;
  double min_surprise = 3;  // minimum Mahalanobis distance of a moving residual
  int min_cells = 4;        // minimum size of a region
  // Minimum number of cells of a region that ego-motion does not match at all.
  int min_proven_cells = 3;
  double min_proven = 0.2;  // minimum of this number as a share of the region's cells
  double highest_on_floor_m = 0.10;
  // Minimum depth of points whose depth neither stereo nor the floor limits.
  double nearest_elsewhere_m = 0.5;
};

// A moving region. It may exceed the object by up to half a patch of the flow (14 px) where the surroundings
// lack texture.
struct MovingRegion {
  int pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // bounding box, px, inclusive
  double center_u = 0, center_v = 0;             // px
  // Mean residual divided by the time between exposures; excludes ego-motion.
  Eigen::Vector2d velocity_px_s{0, 0};
  // Center of the region at the earlier exposure (m) and its velocity (m/s), foot frame. Set if at least a
  // third of the cells have stereo depth. One camera's flow does not measure the velocity component along the
  // ray. The motion is therefore assumed to be horizontal (a rolling object), or, if the ray descends by less
  // than 10 degrees, perpendicular to the ray.
  std::optional<Eigen::Vector3d> position_m, velocity_m_s;
  // 0 to 1: share of the region's cells that ego-motion does not match at all.
  double confidence = 0;
};

struct MovingRegions {
  enum class Depth : std::uint8_t { none, stereo, floor, far };

  FrameInfo before, after;
  // Correction of the ego-motion computed from the postures, in the later optical frame.
  Eigen::Vector3d turn_error_rad{0, 0, 0}, shift_error_m{0, 0, 0};
  double spread_px = 0;  // robust standard deviation of the residuals, per axis
  // One entry per cell of the flow image.
  int cells_across = 0, cells_down = 0;
  std::vector<Eigen::Vector2f> residual_px;  // NaN where flow is unknown
  std::vector<Depth> depth;                  // source of the depth interval; none: unknown flow
  std::vector<std::uint8_t> label;           // region number from 1; 0: static or unknown
  std::vector<MovingRegion> regions;         // largest first, at most 255
};

class IndependentMotionDetector {
 public:
  explicit IndependentMotionDetector(const IndependentMotionOptions& options = {})
      : options_(options) {}

  // Finds the moving regions. `before` and `after` are the images of the flow. `depth` belongs to either
  // image, or is null. Reuses the memory of `moving`, whose contents are undefined after an error. Errors:
  // - the posture is unknown at one of the exposures.
  // - the camera pose jumped (over 5 m/s or 20 rad/s), for example because the supporting foot changed.
  // - the flow contradicts the postures by more than the largest accepted corrections.
  // - the depth image has another exposure or size than the images, or the images have another size than the
  //   flow.
  // - the flow image is empty.
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
  std::vector<Eigen::Vector2i> places_;  // positions, in the depth image, of the samples of a row
  std::vector<std::uint8_t> inside_;
  std::vector<float> disparity_;      // disparities at places_, px
  std::vector<int> columns_;          // centers of the cells of a row, px
  std::vector<std::size_t> cell_;     // cell of each sample
  std::vector<int> sample_;           // by cell: number of the cell's sample, from 1; 0: no sample
  Eigen::Isometry3d later_;           // from the earlier to the later optical frame, corrected
  std::vector<float> inverse_depth_;  // by cell, from stereo; 0 where unknown
  Mask candidates_;                   // by cell
  std::vector<float> grey_[2];        // gray codes of both pictures
  std::vector<std::uint8_t> proven_;  // by cell: ego-motion does not match at all
  std::vector<Eigen::Vector2i> corners_;
  RegionFinder finder_;
};

}  // namespace kaz::vision
