// Computes depth from a rectified stereo pair: disparity, depth, and points in the optical or the foot frame.
// SPDX-License-Identifier: Apache-2.0
//
// The method is block matching, as in: Konolige, "Small vision systems", ISRR 1997. The pictures are first
// filtered by a horizontal derivative, so that differences of exposure and shading cancel out. A match is
// accepted only if it passes three tests.
// - The block has enough texture (`min_texture`), and not all edges in the block run along the rows
//   (depth_aperture.h).
// - The match is unique: other disparities have costs that are higher by more than `uniqueness_percent`. The
//   two disparities next to the match are not checked.
// - Matching the right picture against the left picture finds the same match (left-right check).
// Pixels without an accepted match have no depth. The subpixel part of a disparity is computed from the costs
// of the two neighboring disparities.
//
// Extension for slanted surfaces: a block of a slanted surface, such as the floor, contains several
// disparities. Matching returns the disparity of the strongest edges, wherever these edges are in the block.
// Therefore the largest slanted planes are fitted to the disparities (depth_slants.h). For each plane, the
// right picture is warped so that the plane becomes fronto-parallel. The left picture is then matched with
// the warped picture. A new match replaces the first match if two conditions are met. The new match lies
// within 1 px of the plane, and costs at most 1.25 times as much as the first match. The factor 1.25 is
// kMaxCost_percent in depth_rows.h. This extension does not need the posture.
//
// In the right picture, a point appears further left than in the left picture. For a point at depth z, the
// difference is the disparity `d = fx * baseline / z` (px). Frames: optical (x right, y down, z forward,
// origin at the left lens) and foot, as in frame.h. Units: m, px.
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
  // Minimum measurable depth, m. The range of disparities is fx baseline / nearest_m, rounded up to a
  // multiple of 16 px. This range determines the computing time.
  double nearest_m = 0.14;
  int block_px = 15;  // side of the compared blocks; odd, 5..21
  // Minimum texture of a block of 15 x 15 px. The texture of a block is the sum of the absolute horizontal
  // derivatives at the pixels of the block. For other block sizes, the minimum is scaled by the area of the
  // block. If a block shows a surface of uniform color, noise with a standard deviation of 1.6 gray codes
  // gives the block a texture of 1000. Blocks that contain only noise have no meaningful match.
  int min_texture = 1000;
  // Minimum share by which the costs of other disparities must exceed the lowest cost, percent.
  int uniqueness_percent = 10;
  int left_right_px = 1;  // tolerance of the left-right check, px; negative: no check
  // Maximum number of slanted planes, such as the floor, for which matching is repeated; 0: no second
  // matching.
  int slants = 2;
  bool vectors = true;  // use SIMD where available; the results are the same
};

// One disparity per pixel of the left picture; rows from the top, no padding.
struct DepthImage {
  FrameInfo info;  // time, camera model and posture of the pair
  int width = 0, height = 0;
  std::vector<float> disparity_px;  // 0: unknown

  float disparity(int u, int v) const {
    return disparity_px[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(u)];
  }
  bool known(int u, int v) const { return disparity(u, v) > 0; }
  // Depth along the optical axis, m; NaN where unknown.
  double depth_m(int u, int v) const {
    return known(u, v) ? info.camera.fx * info.camera.baseline_m / disparity(u, v)
                       : std::numeric_limits<double>::quiet_NaN();
  }
};

// View of a gray picture: 8 bits per pixel, rows from the top, no padding. Does not own the pixels.
struct GreyPicture {
  int width = 0, height = 0;
  std::span<const std::uint8_t> pixels;
};

// Computes depth images in the caller's thread. The same pair gives the same result, with SIMD or without.
// Not thread-safe.
class DepthFinder {
 public:
  explicit DepthFinder(const DepthOptions& options = {});
  ~DepthFinder();
  DepthFinder(DepthFinder&&) noexcept;
  DepthFinder& operator=(DepthFinder&&) noexcept;

  // Reuses the memory of `depth`; after an error, the contents of `depth` are undefined. Errors:
  // - an empty or truncated picture.
  // - a picture whose width or height is above 8192 pixels.
  // - a picture whose width or height is at most two blocks.
  // - pictures of different sizes, or pictures that do not have the size given in the camera model.
  // - a picture of one uniform color, for example because the lens is covered or there is no light.
  // - a camera model without focal length or baseline.
  // - options out of range, or a `nearest_m` at which the disparity is not less than the width of the
  //   picture.
  Result<void> find(const StereoImages& pair, const FrameInfo& info, DepthImage& depth);
  Result<void> find(const GreyPicture& left, const GreyPicture& right, const FrameInfo& info,
                    DepthImage& depth);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// One point per pixel of the depth image, in the same order. All three coordinates of an unknown point are
// NaN.
struct PointCloud {
  int width = 0, height = 0;
  std::vector<Eigen::Vector3f> points;  // m
};

// Computes the points in the optical frame of the left eye.
void point_cloud(const DepthImage& depth, PointCloud& cloud);
// Computes the points in the foot frame at the exposure. Error: the posture at the exposure is unknown.
Result<void> point_cloud_before_foot(const DepthImage& depth, PointCloud& cloud);

}  // namespace kaz::vision
