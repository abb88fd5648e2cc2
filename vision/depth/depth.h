// Depth from a rectified stereo pair: disparity, depth, points in the optical and in the foot frame.
// SPDX-License-Identifier: Apache-2.0
//
// Block matching on pictures filtered by a horizontal derivative (K. Konolige, "Small vision
// systems", ISRR 1997), so that exposure and shading cancel out. A match is accepted only if
// - the block has enough texture (`min_texture`), and not only edges along the rows (depth_aperture.h),
// - its cost is lower than that of any other disparity by `uniqueness_percent`,
// - matching the right picture against the left one finds it again (left-right check);
// subpixel interpolation uses the costs of the neighbouring disparities. Other pixels have no depth.
//
// Extension for slanted surfaces: a block of a slanted surface, such as the floor, holds several
// disparities, and matching returns that of its strongest edges, wherever in the block they are. So the
// largest slanted planes are fitted to the disparities (depth_slants.h), the right picture is warped by
// each, which makes the plane fronto-parallel, and is matched again. Matches within 1 px of the plane
// replace the first ones if their cost is not higher. The posture is not needed for that.
//
// A point at depth z shows d = fx baseline / z pixels further left in the right picture. Frames:
// optical (x right, y down, z forward, origin at the left lens) and foot, as in frame.h. m, px.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "vision/image/frame.h"

namespace kaz::vision {

struct DepthOptions {
  // Minimum measurable depth, m. The range of disparities, and with it the computing time, is
  // fx baseline / nearest_m, rounded up to a multiple of 16 px.
  double nearest_m = 0.14;
  int block_px = 15;  // side of the compared blocks; odd, 5..21
  // Minimum sum of absolute codes of the filtered picture over a block of 15 x 15; scaled with the
  // block's area. Noise of 1.6 codes alone sums up to 1000: below that a match is as likely by chance.
  int min_texture = 1000;
  int uniqueness_percent = 10;  // by which the costs of all other disparities must be higher
  int left_right_px = 1;        // tolerance of the left-right check; negative: no check
  // Maximum number of slanted planes, such as the floor, for which matching is repeated with a warped
  // picture (see above); 0: none.
  int slants = 2;
  bool vectors = true;  // use SIMD where the processor has it; results are the same without
};

// One disparity a pixel of the left picture; rows from the top, no padding.
struct DepthImage {
  FrameInfo info;  // of the pair
  int width = 0, height = 0;
  std::vector<float> disparity_px;  // 0 where there is no depth

  float disparity(int u, int v) const {
    return disparity_px[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(u)];
  }
  bool known(int u, int v) const { return disparity(u, v) > 0; }
  // m along the optical axis; NaN where unknown.
  double depth_m(int u, int v) const {
    return known(u, v) ? info.camera.fx * info.camera.baseline_m / disparity(u, v)
                       : std::numeric_limits<double>::quiet_NaN();
  }
};

// 8 bits a pixel, rows from the top, no padding.
struct GreyPicture {
  int width = 0, height = 0;
  std::span<const std::uint8_t> pixels;
};

// Deterministic: the same pair gives the same result, with SIMD or without. Runs in the caller's thread.
class DepthFinder {
 public:
  explicit DepthFinder(const DepthOptions& options = {});
  ~DepthFinder();
  DepthFinder(DepthFinder&&) noexcept;
  DepthFinder& operator=(DepthFinder&&) noexcept;

  // Reuses the memory of `depth`, whose contents are undefined after an error. Errors: pictures that
  // are empty, cut short, of different size or not of the camera model's, smaller than a block or
  // larger than 8192; one colour from edge to edge (a covered lens, no light); a camera model
  // without focal length or baseline; options out of range.
  Result<void> find(const StereoImages& pair, const FrameInfo& info, DepthImage& depth);
  Result<void> find(const GreyPicture& left, const GreyPicture& right, const FrameInfo& info,
                    DepthImage& depth);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// One point a pixel, as in the depth image; NaN in all three where unknown.
struct PointCloud {
  int width = 0, height = 0;
  std::vector<Eigen::Vector3f> points;  // m
};

// In the optical frame of the left eye.
void point_cloud(const DepthImage& depth, PointCloud& cloud);
// In the foot frame at the exposure. Error: the posture at the exposure is not known.
Result<void> point_cloud_before_foot(const DepthImage& depth, PointCloud& cloud);

}  // namespace kaz::vision
