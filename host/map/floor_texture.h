// Computes the floor pattern of a picture as seen from above, and the shift between two such patterns.
// SPDX-License-Identifier: Apache-2.0
//
// If a robot sees the same part of the floor again, the floor's pattern shows the drift of the robot's
// odometry. A view is the floor's brightness at the cell centers of the map, minus the local mean, so that
// the lighting does not matter. Two views are compared by normalized cross-correlation over all shifts and
// turns within a range (Lewis, "Fast normalized cross-correlation", 1995). The sums are integers, so the
// result is the same on every machine. Map frame: x ahead, y left. Units: m, rad.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "host/map/local_map.h"
#include "shared/base/angle.hpp"
#include "vision/image/frame.h"
#include "vision/planes/plane_segments.h"

namespace kaz::map {

// View of the floor: a square of kCells x kCells cells, with the axes of the map.
struct FloorView {
  static constexpr int kCells = 128;
  static constexpr double kCell = 0.008;  // m
  // Indices (x, y) of the view's first cell in the grid of the map; cell (0, 0) begins at the map's origin.
  Eigen::Vector2i corner{0, 0};
  // Brightness at index x * kCells + y, -127..127; 0 where unknown.
  std::vector<std::int16_t> value;
  std::vector<std::uint8_t> known;  // 1: visible floor
  int count = 0;                    // number of known cells
};

// Input of a view: rectified left image, its planes, and the pose of the foot. If `depth` and `map` are not
// null, additional pixels can count as floor. An additional pixel must show a place that is floor on the map.
// The pixel must have no depth, or a depth that agrees with the floor. The additional pixels are important on
// a floor of planks, because stereo measures no depth at edges that are parallel to the picture's rows. All
// references must outlive this object.
struct FloorPictureView {
  const vision::Image& left;
  const vision::PlaneSegments& planes;  // with `info`
  Eigen::Isometry3d map_from_foot;
  const vision::DepthImage* depth = nullptr;
  const LocalMap* map = nullptr;
};
// Returns the view of the square in front of the eye. Floor farther than 0.95 m is too coarse and counts as
// unknown.
FloorView floor_view(const FloorPictureView& picture);

// Correction of the picture's pose that makes the picture agree with an earlier view.
struct FloorShift {
  Eigen::Vector2d shift{0, 0};  // m, shift of the robot, applied after the turn
  double turn_rad = 0;          // turn of the robot about `pivot`
  double correlation = 0;       // -1..1
  double overlap_m2 = 0;
  Eigen::Vector2d middle{0, 0};  // center of the common floor
  // If set, the shift along this direction of the map is unknown, and `shift` has no component in this
  // direction.
  std::optional<Eigen::Vector2d> unknown_along;
};
// Search range, which should be the largest expected error of odometry. Shifts along an axis of the map are
// limited to 64 mm, and turns to 6 degrees. These limits also apply if `shift_m` or `turn_rad` is larger.
struct FloorSearch {
  double shift_m = 0.064, turn_rad = 6 * kDegree;
};
// Compares a picture with views from other places. The objects that the picture refers to must outlive the
// matcher.
class FloorMatcher {
 public:
  // `pivot`: center of the turns that are tried, m, map frame.
  FloorMatcher(const FloorPictureView& picture, const Eigen::Vector2d& pivot);
  // Returns the area of floor, m^2, that is known in both views if the picture's assumed pose is right.
  double floor_in_common(const FloorView& before);
  // Returns the correction, or nothing if there is no clear match. A clear match has at least 0.12 m^2 in
  // common and a correlation of at least 0.4. The peak of the correlation must be inside the search range
  // `within`. Four other shifts are two cells away from the peak, along one axis. At each of them, the two
  // views must also have at least 0.12 m^2 in common. On planks, the shift along the grain is unknown if the
  // correlation hardly falls in that direction.
  std::optional<FloorShift> match(const FloorView& before, const FloorSearch& within = {});
  // Returns the view at the picture's assumed pose.
  const FloorView& view() { return turned(0); }

 private:
  // Turns the picture's assumed pose about `pivot_` by `quarters` times 0.25 degrees, and returns the view at
  // the turned pose.
  const FloorView& turned(int quarters);
  FloorView moved(double turn_rad, const Eigen::Vector2d& shift) const;

  FloorPictureView picture_;
  Eigen::Vector2d pivot_;
  std::map<int, FloorView> turned_;
};

}  // namespace kaz::map
