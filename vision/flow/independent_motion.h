// Detects independently moving objects from optical flow that the ego-motion of the camera does not explain.
// SPDX-License-Identifier: Apache-2.0
//
// Between the two exposures, the camera moves by the ego-motion (R, t). A static point with the ray r = (x,
// y, 1) and the inverse depth w then appears at pi(R r + w t). Here pi is the projection. R and t are
// computed from the joint angles at both exposures and refined with the flow (ego_motion.h). The inverse
// depth of a cell is limited to an interval in one of three ways:
// 1. Where the depth image is valid, the interval is given by the stereo disparity plus or minus one pixel.
// 2. Elsewhere, if the ray intersects the floor plane, the height of the point above the floor is assumed to
//    be 0 to `highest_on_floor_m`.
// 3. In all other cases (above the horizon, or far away), the interval is [0, 1 / nearest_elsewhere_m]. The
//    predicted flow of far points depends mainly on the rotation of the camera.
//
// An interval of inverse depths maps to a line segment of predicted flows. The residual is the vector from
// the nearest point of this line segment to the measured flow. A cell is a candidate if the residual passes
// two tests. The residual must exceed the error bounds of flow and pose. In addition, the Mahalanobis
// distance of the residual must exceed `min_surprise`. This distance is computed with the covariance of the
// flow. The covariance is large along an edge. Flow is smooth and bleeds over object borders, so each
// candidate cell is verified on the images. A candidate cell is static if the predicted flow of a static
// point matches the two images better than the measured flow does. All other candidate cells are moving.
// Connected moving cells form a region only if enough of these cells are proven. A cell is proven if
// ego-motion alone clearly cannot explain the two images. The flow of the region is then estimated again as
// one translation of all pixels of the region. Limitation: where the depth is unknown, motion along the
// epipolar line is not detected.
//
// Frames: pixels of the earlier image; optical and foot frames as in frame.h. The supporting foot must be the
// same at both exposures, and must not move between the exposures. Units: px, m, s.
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
  // Minimum depth of the robot's own shoulders. A region is dropped as a shoulder if two conditions are met.
  // Condition 1: the region reaches the lowest tenth of the image. Condition 2: in more than two thirds of
  // the region's cells, stereo depth is unknown and the flow fits a static object. The static object may have
  // any depth from `nearest_body_m`.
  double nearest_body_m = 0.05;
  // The ego-motion is computed from the postures and then corrected with the flow. `posture_error_rad` and
  // `posture_error_m` are the standard deviations of the ego-motion before this correction.
  // `max_posture_error_rad` and `max_posture_error_m` are the largest accepted corrections. The errors of
  // the ego-motion come from noise and quantization of the potentiometers, backlash of 0.4 degrees, and
  // sway.
  double posture_error_rad = 0.005, max_posture_error_rad = 0.03;
  double posture_error_m = 0.002, max_posture_error_m = 0.01;
  double min_surprise = 3;  // minimum Mahalanobis distance of a candidate's residual
  int min_cells = 4;        // minimum size of a region, cells
  // Minimum number of cells in which ego-motion clearly contradicts the images; regions with fewer of these
  // cells are dropped.
  int min_proven_cells = 3;
  // Like min_proven_cells, but as a share of the region's cells.
  double min_proven = 0.2;
  double highest_on_floor_m = 0.10;
  // If neither stereo nor the floor gives the depth of a point, the depth is assumed to be at least
  // `nearest_elsewhere_m`.
  double nearest_elsewhere_m = 0.5;
};

// A moving region. If the background next to the object has no texture, the region may extend up to 14 px
// beyond the object. These 14 px are half the width of a patch of the flow.
struct MovingRegion {
  int pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // bounding box, px, inclusive
  double center_u = 0, center_v = 0;             // px
  // Velocity in the image without the part that ego-motion causes: mean residual divided by the time between
  // the exposures.
  Eigen::Vector2d velocity_px_s{0, 0};
  // Center (m) of the region at the earlier exposure, and velocity (m/s) of the region, foot frame. Set if at
  // least a third of the region's cells have stereo depth. The flow of one camera does not contain the
  // velocity component along the ray. The motion is therefore assumed to be horizontal, like the motion of a
  // rolling object. If the ray descends by less than 10 degrees, the motion is assumed to be perpendicular to
  // the ray.
  std::optional<Eigen::Vector3d> position_m, velocity_m_s;
  // 0 to 1: share of the region's cells in which ego-motion clearly contradicts the images.
  double confidence = 0;
};

struct MovingRegions {
  enum class Depth : std::uint8_t { none, stereo, floor, far };

  FrameInfo before, after;
  // Correction of the ego-motion that was computed from the postures, in the later optical frame.
  Eigen::Vector3d turn_error_rad{0, 0, 0}, shift_error_m{0, 0, 0};
  double spread_px = 0;  // robust standard deviation of the residuals, per axis
  // Size of the grid of cells, as in the flow image. residual_px, depth and label have one entry per cell.
  int cells_across = 0, cells_down = 0;
  std::vector<Eigen::Vector2f> residual_px;  // NaN where flow is unknown
  // Source of the depth interval. The value `none` means that the flow is unknown.
  std::vector<Depth> depth;
  std::vector<std::uint8_t> label;    // region number from 1; 0: static or unknown
  std::vector<MovingRegion> regions;  // largest first, at most 255
};

class IndependentMotionDetector {
 public:
  explicit IndependentMotionDetector(const IndependentMotionOptions& options = {})
      : options_(options) {}

  // Finds the moving regions. `before` and `after` are the images of the flow. `depth` is the depth image of
  // `before` or `after`, or null. Reuses the memory of `moving`; after an error, the contents of `moving` are
  // undefined. Errors:
  // - the posture is unknown at one of the exposures.
  // - the camera pose jumped (over 5 m/s or 20 rad/s), for example because the supporting foot changed.
  // - the flow contradicts the postures by more than the largest accepted corrections.
  // - the exposure of the depth image is neither the exposure of `before` nor the exposure of `after`.
  // - the images, the depth image and the flow image differ in size.
  // - the flow image is empty.
  // - no time passed between the exposures.
  // - the depth image has no camera model.
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
  // For one row of cells: position of each sample in the depth image.
  std::vector<Eigen::Vector2i> places_;
  std::vector<std::uint8_t> inside_;
  std::vector<float> disparity_;   // disparities at places_, px
  std::vector<int> columns_;       // centers of the cells of a row, px
  std::vector<std::size_t> cell_;  // index of each sample's cell
  std::vector<int> sample_;  // for each cell: index of its sample in samples_, plus 1; 0: no sample
  // Corrected transform from the earlier to the later optical frame.
  Eigen::Isometry3d later_;
  std::vector<float> inverse_depth_;  // by cell: inverse depth from stereo, 1/m; 0: unknown
  Mask candidates_;                   // cells that are candidates
  std::vector<float> grey_[2];        // gray codes of both pictures
  // For each cell: 1 if ego-motion alone clearly cannot explain the images.
  std::vector<std::uint8_t> proven_;
  std::vector<Eigen::Vector2i> corners_;
  RegionFinder finder_;
};

}  // namespace kaz::vision
