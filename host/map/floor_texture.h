// Floor pattern in a picture, seen from above, and the shift between two such views.
// SPDX-License-Identifier: Apache-2.0
//
// When a robot stands where it saw the floor before, the floor's pattern shows the drift of its odometry. A
// view is the floor's brightness at the cell centers of the map, minus the local mean, so that light does
// not matter. Two views are compared by normalized cross-correlation over all shifts and turns within a
// range (J. P. Lewis, "Fast normalized cross-correlation", 1995). The sums are integers, so the result is
// the same on every machine. Map frame: x ahead, y left. Units: m, rad.
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
  Eigen::Vector2i corner{0, 0};     // number of the first cell; cell 0 begins at the map's origin
  std::vector<std::int16_t> value;  // [x * kCells + y], -127..127; 0 where unknown
  std::vector<std::uint8_t> known;  // 1: visible floor
  int count = 0;                    // number of known cells
};

// Input of a view: rectified left image, its planes, and the pose of the foot. With `depth` and `map`,
// pixels also count as floor if the map has floor there and the pixel's depth is missing or agrees. Without
// these pixels, a floor of planks shows little of its pattern, because the edges of planks are parallel to
// the picture's rows. All references must outlive this object.
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

// Correction to the pose of the picture, so that it agrees with `before`.
struct FloorShift {
  Eigen::Vector2d shift{0, 0};  // m, of the robot, after the turn
  double turn_rad = 0;          // about `pivot`
  double correlation = 0;       // -1..1
  double overlap_m2 = 0;
  Eigen::Vector2d middle{0, 0};  // center of the common floor
  // If set, the shift along this direction of the map is unknown, and `shift` is 0 along it.
  std::optional<Eigen::Vector2d> unknown_along;
};
// Search range: the largest expected error of odometry. The search covers at most 64 mm and 6 degrees.
struct FloorSearch {
  double shift_m = 0.064, turn_rad = 6 * kDegree;
};
// Compares a picture with views from other places. The objects that the picture refers to must outlive
// this.
class FloorMatcher {
 public:
  // `pivot`: center of the turns, m, map frame.
  FloorMatcher(const FloorPictureView& picture, const Eigen::Vector2d& pivot);
  // Area of floor, m^2, that is known in both views, at the picture's assumed pose.
  double floor_in_common(const FloorView& before);
  // Returns the correction, or nothing if there is no clear match. A clear match has at least 0.12 m^2 in
  // common and a correlation of at least 0.4. Its peak is inside `within` and inside the range with enough
  // common floor. On planks, the shift along the grain is unknown if the correlation hardly falls in that
  // direction.
  std::optional<FloorShift> match(const FloorView& before, const FloorSearch& within = {});
  // View at the picture's assumed pose.
  const FloorView& view() { return turned(0); }

 private:
  // Returns the view of the picture turned by this number of quarter degrees.
  const FloorView& turned(int quarters);
  FloorView moved(double turn_rad, const Eigen::Vector2d& shift) const;

  FloorPictureView picture_;
  Eigen::Vector2d pivot_;
  std::map<int, FloorView> turned_;
};

}  // namespace kaz::map
