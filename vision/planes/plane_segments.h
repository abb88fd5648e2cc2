// Plane segments in a depth image: where there are planes, how they lie, and which are the floor.
// SPDX-License-Identifier: Apache-2.0
//
// The paper finds the floor by the Plane Segment Finder (section 4.1; K. Okada, S. Kagami, M.
// Inaba, H. Inoue, "Plane segment finder: algorithm, implementation and applications", ICRA 2001),
// known as a randomised three-dimensional Hough transform followed by a fit of the plane's regions.
// Its text was not at hand; what is followed is that description:
// 1. Three points near each other, drawn at random, are a plane and give it one vote, by direction
//    of its normal and distance from the eye.
// 2. Where votes crowd there is a plane. It is fitted to the points that lie on it.
// 3. What lies on it and hangs together is a segment. The rest is voted on again, for more planes.
// 4. The floor is what agrees with the plane under the sole of the supporting foot, from the
//    posture at the exposure of the picture.
// Departures: points are means over squares of some 1/80 of the picture's width; planes are fitted,
// and distances from them judged, in disparity, where the noise of stereo is the same near and far
// (a plane in space is d = a u + b v + c there); each plane is voted on anew, so that a small one
// is not drowned by the floor's votes; pixels, not squares, are given to the plane they are nearest
// to.
//
// Units m, px, rad; optical frame of the left eye (frame.h).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"

namespace kaz::vision {

struct PlaneOptions {
  std::uint64_t seed = 1;     // of the draws: same picture, same seed, same segments
  int triples = 1500;         // drawn for the first plane; a third of that for each further one
  int max_planes = 8;         // 1..16
  double tolerance_px = 0.6;  // of disparity, from the plane to a point that still belongs to it
  double min_share = 0.006;   // of the picture: smaller segments are not reported
  // How far the floor may seem off the plane under the sole: what posture and calibration err.
  double floor_angle_rad = 0.10;
  double floor_height_m = 0.02;  // in the middle of the segment
};

struct PlaneSegment {
  int plane = 0;  // segments with the same number lie in one plane
  // Of the plane: points p with normal . p = -distance_m. Unit, towards the eye.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance_m = 0;  // from the eye, > 0
  double error_px = 0;    // rms of the segment's pixels from the plane, in disparity
  double error_m = 0;     // the same across the plane
  int pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // box in the picture, all four inside, px
  // On the plane: middle of the points, directions of largest and smallest spread (unit), and how far
  // the segment reaches along them, from middle to middle of its outermost squares: up to one and a
  // half of them a side less than it is.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector3d along = Eigen::Vector3d::UnitX(), across = Eigen::Vector3d::UnitY();
  double length_m = 0, width_m = 0;
  bool floor = false;  // agrees with the sole; false for all where the posture is not known
};

struct PlaneSegments {
  FrameInfo info;  // of the pair
  int width = 0, height = 0;
  std::vector<PlaneSegment> segments;  // planes as found, the largest segment of each first
  std::vector<std::uint8_t> label;     // per pixel: 0 none, n: segments[n - 1]

  bool floor_found() const {
    for (const PlaneSegment& s : segments) {
      if (s.floor) return true;
    }
    return false;
  }
};

class PlaneSegmentFinder {
 public:
  explicit PlaneSegmentFinder(const PlaneOptions& options = {});
  ~PlaneSegmentFinder();
  PlaneSegmentFinder(PlaneSegmentFinder&&) noexcept;
  PlaneSegmentFinder& operator=(PlaneSegmentFinder&&) noexcept;

  // Reuses the memory of `found`, whose contents mean nothing after an error. No planes is no
  // error. Disparities that are not above 0, or not finite, count as unknown. Errors: a depth image
  // smaller than 32 x 32 or whose numbers do not fit its size; a camera model without focal length
  // or baseline; options out of range.
  Result<void> find(const DepthImage& depth, PlaneSegments& found);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
