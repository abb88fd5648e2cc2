// Local map: an occupancy grid of floor and obstacles around the robot.
// SPDX-License-Identifier: Apache-2.0
//
// Follows the paper (README.md), section 4.1 "Conversion of Coordinates to Generate Local Map" and "Map
// Merging". The detections of each picture are transformed to the map by the camera pose at its exposure.
// Pictures are merged cell by cell, with a confidence.
//
// Map frame: x forward, y left, z up, as the foot frame (vision/image/frame.h) when the map was begun. The
// floor is z = 0. Units: m, px.
//
// Each picture gives a cell at most one vote:
// - Floor. The center of each cell in view is projected into the picture. The cell is floor if the pixel
//   belongs to the floor segment. Pixels at the sides of the picture do not count: a thing that is cut off
//   there may be labeled floor. Projecting cells to pixels, not pixels to cells, leaves no holes far away,
//   where a pixel is larger than a cell. It also clears nothing behind an obstacle.
// - Obstacle. Each other pixel with a depth is a point. It votes for its cell if it is lower than the robot
//   and higher than `obstacle_m`. It must also be above the floor by three sigma of its height. The vote is
//   1 if the points fill a quarter of a cell's width and height. It is less if a neighboring cell has more
//   points. Stereo errors are along the ray, and an obstacle's face is not in front of its foot. So a point
//   whose cell is floor in the same picture is moved along its ray, by up to two sigma, to a cell without
//   floor. A point within three sigma of the end of the floor below it stands at that end. So does a plain
//   face, without depth, between two standing edges (contact_line.h).
// - Hole. If a point is below the floor by more than `drop_m` and three sigma, its ray meets no floor at
//   the floor's height. The cell there is an obstacle.
//
// Some points are strays and do not count. A point is a stray if the points above and below have another
// depth, or if a cell has fewer points than even a low obstacle. A point beyond the floor's end is also a
// stray if it is lower than the object that stands at this end: its depth is mixed from the object's rim and
// the floor behind the object (contact_line.h).
//
// Tilt, roll and height of the eye are taken from the floor's plane if at least a tenth of the picture
// shows it. The posture of a walking robot errs by 0.65 degrees and 4 mm (one sigma), which is 4 cm of
// floor at 1 m.
//
// The weight of a vote is min(1, cell_m / dz), with dz = z^2 / (fx baseline) disparity_error_px, one sigma
// of the depth z. Votes add up as log-odds, so their order does not matter until a cell saturates. An
// obstacle saturates at 10, floor at -3, which is five votes.
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
  double size_m = 4.0;        // side; the origin is in the middle; 2 to 2000 cells
  double farthest_m = 1.5;    // maximum distance from the eye along the floor
  double obstacle_m = 0.015;  // objects up to this height are no obstacles
  // Depth below the floor from which a point shows a hole or an edge.
  double drop_m = 0.03;
  double robot_m = 0.36;  // height of the robot; things above this height are no obstacles
  // Points nearer than this to the foot's origin belong to the robot. There, floor does not clear an
  // obstacle that several pictures have shown.
  double own_m = 0.13;
  double disparity_error_px = 0.2;  // one sigma
};

struct Cell {
  CellState state = CellState::unknown;
  double confidence = 0;  // 0..1: |2p - 1|, with the probability p of an obstacle
};

// A part of the robot that its eyes may see: a capsule around the line from `from` to `to`. Foot frame
// (vision/image/frame.h) at the exposure, m.
struct OwnPart {
  Eigen::Vector3d from, to;
  double radius_m = 0;
};

// State of a rectangle: blocked if any of its cells is an obstacle, free if all are floor.
enum class Footprint { free, blocked, unknown };

struct MapCounts {
  std::uint64_t updates = 0;
  std::uint64_t without_posture = 0;  // rejected pictures
  std::uint64_t out_of_order = 0;     // rejected pictures
};

class LocalMap {
 public:
  // Errors (usage): options out of range.
  static Result<LocalMap> make(const LocalMapOptions& options = {});

  // Enters the floor and depth of one image pair. `info` (usually planes.info) contains camera and posture.
  // `map_from_foot` is the pose of the foot at the exposure, with its sole on z = 0. Pixels that show
  // `own`, or lie within 10 px (at a width of 320) of its outline, are no obstacles.
  //
  // Errors (failed): the posture at the exposure is unknown, or the exposure is not later than that of the
  // last update. Errors (usage): planes and depth of different exposures or sizes, no camera model, or
  // numbers that are not finite. After an error, only counts() has changed.
  Result<void> update(const vision::PlaneSegments& planes, const vision::DepthImage& depth,
                      const vision::FrameInfo& info,
                      const Eigen::Isometry3d& map_from_foot = Eigen::Isometry3d::Identity(),
                      std::span<const OwnPart> own = {});
  // Resets all cells, counts() and the time of the last update.
  void clear();
  // Reduces the weight of old evidence: multiplies all log-odds by `share`, 0..1.
  void fade(double share);

  // Cells are numbered from 0 at the rear right corner. Everything outside of the map is unknown.
  int cells() const { return cells_; }  // along each side
  const LocalMapOptions& options() const { return options_; }
  Cell cell(int x, int y) const;
  Cell at(double x_m, double y_m) const { return cell(number(x_m), number(y_m)); }
  // Number of the cell that contains this coordinate.
  int number(double m) const;
  double middle(int cell) const;  // center of a cell, m
  // Like the state of cell(), but an obstacle with only a single vote is reported as unknown.
  CellState certain(int x, int y) const;
  CellState certain_at(double x_m, double y_m) const { return certain(number(x_m), number(y_m)); }
  // Log-odds of an obstacle; 0 if unknown.
  double log_odds(int x, int y) const;

  // Returns the state of a rectangle, `length_m` long on its forward axis and `width_m` wide, with its
  // center at `pose` in the map. It covers the cells whose center is inside.
  Footprint footprint(const Eigen::Isometry2d& pose, double length_m, double width_m) const;

  // Returns a picture of the map, one pixel per cell: floor green, obstacle red, unknown gray; paler where
  // the confidence is lower. Forward is up.
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
  // Members of the current update():
  std::vector<std::uint32_t> seen_;    // number of the last update that showed floor here
  std::vector<float> hits_;            // votes for an obstacle
  std::vector<std::uint16_t> points_;  // number of obstacle points
  std::vector<std::uint32_t> touched_;
  std::vector<int> row_u_, row_v_, row_vote_;  // pixel coordinates and votes for a row of cells
  ContactLine contact_;
  std::vector<float> row_up_;      // heights in a row of pixels, m
  std::vector<std::uint8_t> own_;  // by pixel; 1: shows the robot itself
};

}  // namespace kaz::map
