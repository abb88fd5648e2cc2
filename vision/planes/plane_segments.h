// Finds plane segments in a depth image with their geometry, and determines which segments are floor.
// SPDX-License-Identifier: Apache-2.0
//
// The paper finds the floor with the Plane Segment Finder (section 4.1; K. Okada, S. Kagami, M. Inaba, H.
// Inoue, "Plane segment finder: algorithm, implementation and applications", ICRA 2001). The Plane Segment
// Finder first finds planes by a randomized three-dimensional Hough transform. Then the Plane Segment Finder
// fits each plane to the image regions that lie on the plane. We had no access to the text of Okada et al.
// and follow the description in the paper.
// 1. Three neighboring points, drawn at random, define a plane: the plane's normal and its distance from the
//    eye. Each triple of points is one vote for the plane through these points.
// 2. A peak of votes is taken as a plane. The plane is then fitted to the points near the plane.
// 3. Connected points on the plane form a segment. The remaining points vote again for further planes.
// 4. A segment is floor if the segment agrees with the plane under the sole of the supporting foot. The plane
//    under the sole is computed from the posture at the exposure.
//
// Differences from the paper: points are means over squares with sides of about 1/80 of the picture's width.
// Fits of planes and distances from planes are computed in disparity, because the stereo noise of disparity
// is the same for near and far points. In a disparity image, every plane in space has the equation
// `d = a u + b v + c`. Each plane has its own round of votes, so that the floor does not hide a small plane.
// At the end, single pixels instead of squares are assigned to the nearest plane.
//
// Units: m, px, rad. Frame: optical frame of the left eye (frame.h).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "vision/depth/depth.h"

namespace kaz::vision {

struct PlaneOptions {
  std::uint64_t seed = 1;  // seed of the random draws; the same seed gives the same segments
  // Number of draws for the first plane; each further plane gets a third of this number.
  int triples = 1500;
  int max_planes = 8;         // 1..16
  double tolerance_px = 0.6;  // maximum distance of a point from the plane, in disparity
  double min_share = 0.006;   // minimum size of a segment, as a share of the picture
  // Maximum differences between a floor segment and the plane under the sole. The differences come from
  // errors of posture and calibration.
  double floor_angle_rad = 0.10;
  double floor_height_m = 0.02;  // difference in height, at the middle of the segment
};

struct PlaneSegment {
  int plane = 0;  // plane number; several segments may lie in one plane
  // Unit normal towards the eye. Points p of the plane satisfy normal . p = -distance_m.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance_m = 0;  // distance of the plane from the eye, > 0
  double error_px = 0;    // rms distance of the segment's pixels from the plane, in disparity
  double error_m = 0;     // rms distance of the segment's pixels perpendicular to the plane, m
  int pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // bounding box, inclusive, px
  // `middle` is the mean of the points. `along` and `across` are perpendicular unit vectors in the plane.
  // The points spread most in the direction `along`, and least in the direction `across`. `length_m` is the
  // extent of the points in the direction `along`. `width_m` is the extent in the direction `across`. Both
  // extents are measured between the middles of the outermost squares. The real segment may be larger. At
  // each end, the segment may extend beyond the middle of the outermost square by up to one and a half
  // squares.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector3d along = Eigen::Vector3d::UnitX(), across = Eigen::Vector3d::UnitY();
  double length_m = 0, width_m = 0;
  // True if the segment agrees with the plane under the sole; false if the posture is unknown.
  bool floor = false;
};

struct PlaneSegments {
  FrameInfo info;  // frame information of the pair
  int width = 0, height = 0;
  // Sorted by the order in which the planes were found; within a plane, the largest segment is first.
  std::vector<PlaneSegment> segments;
  std::vector<std::uint8_t> label;  // for each pixel: index in `segments` plus 1; 0: no segment

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

  // Reuses the memory of `found`; after an error, the contents of `found` are undefined. It is not an error
  // if no plane is found. Disparities that are not above 0 or not finite count as unknown. Errors:
  // - a depth image whose width or height is outside the range of 32 to 8192 pixels.
  // - a depth image whose data do not match its width and height.
  // - a camera model without focal length or baseline.
  // - options out of range.
  Result<void> find(const DepthImage& depth, PlaneSegments& found);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kaz::vision
