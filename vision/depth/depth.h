// Depth from a rectified stereo pair: disparity, depth, points before the eye and before the foot.
// SPDX-License-Identifier: Apache-2.0
//
// Block matching on pictures filtered by a horizontal derivative (K. Konolige, "Small vision
// systems", ISRR 1997), so that exposure and shading cancel out. A match counts only where it
// - has texture to hold on to,
// - is better than any other disparity by some per cent,
// - is found again when the right picture is matched against the left one (left-right check),
// and is then placed between pixels by the costs of its neighbours. All else is marked as having no
// depth.
// Departures: a block of a slanted surface, such as the floor, holds several disparities, and gets
// that of its strongest edges, wherever in the block they are. So the largest slanted planes among
// the disparities found are looked for (depth_slants.h), the right picture is moved by each, after
// which the plane faces the eyes, and what is found within 1 px of it, at a cost not worse, counts.
// Nothing of the posture is needed for that.
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
  // Nearer things have no depth. The work grows with fx baseline / nearest_m, which is rounded up
  // to a multiple of 16 px.
  double nearest_m = 0.14;
  int block_px = 15;  // side of the squares that are compared; odd, 5..21
  // Least sum of the filtered picture's codes over a block of 15 x 15; grows with the block's area.
  // Noise of 1.6 codes alone gives 1000: below that a match is chance as likely as not.
  int min_texture = 1000;
  int uniqueness_percent = 10;  // how much worse all other disparities must be
  int left_right_px = 1;        // how far the way back may miss; negative: no check
  // Planes in the picture, such as the floor, that blocks are slanted like in a second comparison:
  // blocks facing the eyes see a slant where its edges are, not where their middle is. 0: none.
  int slants = 2;
  bool vectors = true;  // the processor's, where it has them; results are the same without
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

// Same pair, same result, with the processor's vectors or without. In the caller's thread.
class DepthFinder {
 public:
  explicit DepthFinder(const DepthOptions& options = {});
  ~DepthFinder();
  DepthFinder(DepthFinder&&) noexcept;
  DepthFinder& operator=(DepthFinder&&) noexcept;

  // Reuses the memory of `depth`, whose contents mean nothing after an error. Errors: pictures that
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
// In the foot frame of the moment of the exposure. An error where the posture then is not known.
Result<void> point_cloud_before_foot(const DepthImage& depth, PointCloud& cloud);

}  // namespace kaz::vision
