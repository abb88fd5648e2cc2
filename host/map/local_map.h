// Local map: an occupancy grid of floor and obstacles around the robot.
// SPDX-License-Identifier: Apache-2.0
//
// Follows the paper (README.md), section 4.1 "Conversion of Coordinates to Generate Local Map" and "Map
// Merging". The detections of each picture are transformed to the map by the camera pose at its exposure. The
// detections of all pictures are merged cell by cell, and each cell has a confidence.
//
// Map frame: x forward, y left, z up. When the robot starts a map, the map frame is equal to the foot frame
// (vision/image/frame.h). The floor is z = 0. Units: m, px.
//
// Each picture gives a cell at most one vote:
// - Floor. The center of each cell in view is projected into the picture. The cell is floor if the pixel
//   belongs to the floor segment. Pixels at the sides of the picture do not count, because an object that is
//   cut off at a side may be labeled floor. Cells are projected to pixels, not pixels to cells. So the map
//   has no holes at large distances, where a pixel covers more than one cell. Also, cells behind an obstacle
//   get no floor votes.
// - Obstacle. Each pixel with a depth is converted to a point in space, except pixels of the floor segment. A
//   point votes for an obstacle in its cell if the point is higher than `obstacle_m` and lower than the
//   robot. The height must also be larger than three standard deviations of the height. Each point covers the
//   area of its pixel, in m^2, at the depth of the point. A cell's vote is 1 if the cell's points cover at
//   least a quarter of a square whose side is `cell_m`. Then the area covered by the points of the cell is
//   compared with the areas of the neighboring cells. If a neighbor's area is larger than kUneven (votes.h)
//   times the cell's area, the cell's vote is reduced. Stereo errors move a point only along its ray, and the
//   face of an obstacle is never nearer than the obstacle's foot. So if a picture shows floor in a cell, each
//   obstacle point of the same picture in this cell has a wrong position. Such a point is moved away from the
//   camera along its ray, by up to two sigma, to a cell without floor. If the floor ends below a point in the
//   picture, the distance of the point from the eye is compared with the distance of the floor's end. If
//   these two distances differ by at most three sigma, the point is moved to the end of the floor. A face
//   without texture has no depth between its two edges. If both edges are at the end of the floor, the whole
//   face is placed there (contact_line.h).
// - Hole. A point counts as below the floor if its depth below the floor exceeds both `drop_m` and three
//   sigma. The ray from the eye to such a point passes through the plane z = 0 at a place where floor is
//   missing. The cell at this place gets a vote for an obstacle.
//
// Some points are strays and do not count. A point is a stray if its disparity and the disparity of the point
// above in the picture differ by at least kSmooth_px (votes.h). A point is also a stray if its disparity and
// the disparity of the point below in the picture differ by at least kSmooth_px. A point is also a stray if
// its cell and the eight neighboring cells together contain too few points (kMinPoints and kMinShare in
// votes.h). Behind an object that stands at the end of the floor, a point is also a stray if it is lower than
// the object's top. The depth of such a point is a mixture of the depths of the object's rim and of the floor
// behind the object (contact_line.h).
//
// Tilt, roll and height of the eye are taken from the floor's plane if at least a tenth of the picture shows
// this plane. Otherwise these values are computed from the robot's posture, which is less exact. While the
// robot walks, one sigma of the computed values is 0.65 degrees for the angles and 4 mm for the height. At a
// distance of 1 m, such errors move a point of the floor by 4 cm.
//
// The weight of a vote is min(1, cell_m / dz). Here, dz is the standard deviation of the depth z: dz =
// disparity_error_px * z^2 / (fx * baseline). Votes add up as log-odds, so their order does not matter until
// a cell saturates. A cell saturates as an obstacle at log-odds of 10. A cell saturates as floor at log-odds
// of -3, which five votes reach.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "host/map/contact_line.h"
#include "shared/base/result.hpp"
#include "vision/depth/depth.h"
#include "vision/image/frame.h"
#include "vision/planes/plane_segments.h"

namespace kaz::map {

enum class CellState { unknown, floor, obstacle };

struct LocalMapOptions {
  double cell_m = 0.01;
  // Length of the map's side, 2 to 2000 cells; the origin is in the middle.
  double size_m = 4.0;
  double farthest_m = 1.5;    // maximum distance from the eye along the floor
  double obstacle_m = 0.015;  // objects up to this height are no obstacles
  // Minimum depth below the floor at which a point counts as a hole or an edge.
  double drop_m = 0.03;
  double robot_m = 0.36;  // height of the robot; things above this height are no obstacles
  // Radius around the foot's origin in which points belong to the robot. Within this radius, an obstacle that
  // several pictures have shown stays in the map, even if a picture shows floor there.
  double own_m = 0.13;
  double disparity_error_px = 0.2;  // standard deviation of the disparity
};

struct Cell {
  CellState state = CellState::unknown;
  // From 0 to 1: |2p - 1|, where p is the probability that the cell is an obstacle.
  double confidence = 0;
};

// A part of the robot that its eyes may see: a capsule around the line from `from` to `to`. Coordinates are
// in the foot frame (vision/image/frame.h) at the exposure, m.
struct OwnPart {
  Eigen::Vector3d from, to;
  double radius_m = 0;
};

// State of a rectangle: blocked if any of its cells is an obstacle, free if all its cells are floor, else
// unknown.
enum class Footprint { free, blocked, unknown };

struct MapCounts {
  std::uint64_t updates = 0;
  std::uint64_t without_posture = 0;  // pictures rejected because the posture was unknown
  // pictures rejected because they were not newer than the last update
  std::uint64_t out_of_order = 0;
};

class LocalMap {
 public:
  // Errors (usage): options out of range.
  static Result<LocalMap> make(const LocalMapOptions& options = {});

  // Enters the floor and depth of one image pair. `info` (usually planes.info) contains camera and posture.
  // `map_from_foot` is the pose of the foot at the exposure, with the sole on z = 0. `own` lists parts of the
  // robot. Pixels on these parts are not entered as obstacles. Pixels near a part are not entered either, up
  // to a distance of 1/32 of the picture's width.
  //
  // Errors (failed): the posture at the exposure is unknown, or the exposure is not later than the exposure
  // of the last update. Errors (usage): planes and depth have different exposures or sizes, the camera model
  // is missing, or a number is not finite. After an error, only counts() has changed.
  Result<void> update(const vision::PlaneSegments& planes, const vision::DepthImage& depth,
                      const vision::FrameInfo& info,
                      const Eigen::Isometry3d& map_from_foot = Eigen::Isometry3d::Identity(),
                      std::span<const OwnPart> own = {});
  // Resets all cells, counts() and the time of the last update.
  void clear();
  // Reduces the weight of old evidence: multiplies all log-odds by `share`, 0..1.
  void fade(double share);

  // Cells are numbered from 0 at the rear right corner. Everything outside of the map is unknown.
  int cells() const { return cells_; }  // number of cells along each side
  const LocalMapOptions& options() const { return options_; }
  Cell cell(int x, int y) const;
  Cell at(double x_m, double y_m) const { return cell(number(x_m), number(y_m)); }
  // Returns the number of the cell that contains the coordinate `m`, along either axis.
  int number(double m) const;
  double middle(int cell) const;  // center of a cell, m
  // Returns the state of cell(), with one exception: for an obstacle with only one vote, returns
  // CellState::unknown.
  CellState certain(int x, int y) const;
  CellState certain_at(double x_m, double y_m) const { return certain(number(x_m), number(y_m)); }
  // Returns the log-odds of an obstacle in the cell; 0 if unknown.
  double log_odds(int x, int y) const;

  // Returns the state of a rectangle, `length_m` long on its forward axis and `width_m` wide, with its center
  // at `pose` in the map. The rectangle covers the cells whose center is inside the rectangle.
  Footprint footprint(const Eigen::Isometry2d& pose, double length_m, double width_m) const;

  // Returns a picture of the map, one pixel per cell: floor green, obstacle red, unknown gray. A paler color
  // means a lower confidence. Forward is up in the picture.
  vision::Image picture() const;
  const MapCounts& counts() const { return counts_; }

 private:
  struct View;
  explicit LocalMap(const LocalMapOptions& options);
  Result<void> check(const vision::PlaneSegments& planes, const vision::DepthImage& depth,
                     const vision::FrameInfo& info, const Eigen::Isometry3d& map_from_foot);
  void see_floor(const View& view, const vision::PlaneSegments& planes,
                 const Eigen::Vector2d& foot);
  void see_obstacles(const View& view, const vision::PlaneSegments& planes,
                     const vision::DepthImage& depth, const Eigen::Vector2d& foot);
  void mask(const OwnPart& part, const vision::FrameInfo& info);
  void enter_obstacles(const View& view, int width);
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(cells_) +
           static_cast<std::size_t>(y);
  }

  LocalMapOptions options_;
  int cells_ = 0;
  Time last_{};
  MapCounts counts_;
  std::vector<std::int16_t> odds_;  // log-odds in steps of kStep
  // The members below are used only during update().
  std::vector<std::uint32_t> seen_;    // by cell: number of the last update that showed floor
  std::vector<float> hits_;            // by cell: votes for an obstacle
  std::vector<std::uint16_t> points_;  // by cell: number of obstacle points
  std::vector<std::uint32_t> touched_;
  std::vector<int> row_u_, row_v_, row_vote_;  // pixel coordinates and votes for a row of cells
  ContactLine contact_;
  std::vector<float> row_up_;      // heights of the points in a row of pixels, m
  std::vector<std::uint8_t> own_;  // by pixel; 1: shows the robot itself
};

}  // namespace kaz::map
