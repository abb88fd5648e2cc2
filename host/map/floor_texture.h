// What a picture shows of the floor's pattern, seen from above, and how two such views are off each other.
// SPDX-License-Identifier: Apache-2.0
//
// A robot that stands again where the floor was seen before knows by the floor's pattern how far its odometry
// has drifted. A view is the floor's brightness at the cells' middles in the map, less the mean around
// each, so that light does not matter. Two views are compared by normalized cross-correlation over all shifts
// and turns within a range (J. P. Lewis, "Fast normalized cross-correlation", 1995), in whole numbers: the
// same result on every machine. Frame of the map: x ahead, y left. m, rad.
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

// Of the floor around `middle`: a square of kCells cells, axes as the map's.
struct FloorView {
  static constexpr int kCells = 128;
  static constexpr double kCell = 0.008;  // m
  Eigen::Vector2i corner{0, 0};           // number of the first cell; 0 begins at the map's origin
  std::vector<std::int16_t> value;        // [x * kCells + y], -128..127; 0 where not known
  std::vector<std::uint8_t> known;        // 1: floor that the picture shows
  int count = 0;                          // of the known
};

// A picture of which views are made: rectified left image, its planes and where the foot was. With `depth`
// and `map` also floor counts that the map knows and of which this picture has no depth (edges along the
// rows): else a floor of planks shows little of its pattern.
struct FloorPictureView {
  const vision::Image& left;
  const vision::PlaneSegments& planes;  // with info
  Eigen::Isometry3d map_from_foot;
  const vision::DepthImage* depth = nullptr;
  const LocalMap* map = nullptr;
};
// The square before the eye. Floor farther than 0.95 m is too coarse and counts as unknown.
FloorView floor_view(const FloorPictureView& picture);

// What is added to the pose of `picture` so that it agrees with `before`.
struct FloorShift {
  Eigen::Vector2d shift{0, 0};  // m, of the robot
  double turn_rad = 0;          // about `pivot`, first
  double correlation = 0;       // -1..1
  double overlap_m2 = 0;
  Eigen::Vector2d middle{0, 0};  // of the floor in common
  // Along this direction of the map the shift is not known, and 0.
  std::optional<Eigen::Vector2d> unknown_along;
};
// How far the two may be off each other: what odometry can have erred by. At most 64 mm and 6 degrees are
// searched.
struct FloorSearch {
  double shift_m = 0.064, turn_rad = 6 * kDegree;
};
// Compares a picture with views of other places. The picture must outlive this.
class FloorMatcher {
 public:
  // `pivot`: about which the picture's turn is searched.
  FloorMatcher(const FloorPictureView& picture, const Eigen::Vector2d& pivot);
  // m^2, of floor that both know, where the picture claims to be.
  double floor_in_common(const FloorView& before);
  // Along the grain of a floor of planks there is no shift where the correlation hardly falls in that
  // direction. Nothing: less than 0.12 m^2 in common, or no clear match (a correlation under 0.4, or the best
  // at the rim of the range, or of what is in common).
  std::optional<FloorShift> match(const FloorView& before, const FloorSearch& within = {});
  // As the picture claims to be placed.
  const FloorView& view() { return turned(0); }

 private:
  // The view of the picture turned by so many quarters of a degree.
  const FloorView& turned(int quarters);
  FloorView moved(double turn_rad, const Eigen::Vector2d& shift) const;

  FloorPictureView picture_;
  Eigen::Vector2d pivot_;
  std::map<int, FloorView> turned_;
};

}  // namespace kaz::map
