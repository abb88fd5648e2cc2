// The local map: an occupancy grid of floor and obstacles around the robot.
// SPDX-License-Identifier: Apache-2.0
//
// After the paper, section 4.1 "Conversion of Coordinates to Generate Local Map" and "Map Merging":
// the detections of each picture are transformed to the map by the camera pose at its exposure, and pictures
// are merged cell by cell, with a confidence.
//
// Frame of the map: x forward, y left, z up, as the foot frame (vision/image/frame.h) at the time the
// map was begun; the floor is z = 0. Units m, px.
//
// Each picture gives a cell at most one vote:
// - Floor. The middle of each cell in view is projected into the picture; the cell is floor if the pixel
//   belongs to the floor segment, and is not at a side of the picture, where what is cut off a thing may be
//   called floor. Projecting cells to pixels, not pixels to cells, leaves no holes far
//   away, where a pixel is larger than a cell, and clears nothing behind an obstacle.
// - Obstacle. Each other pixel with a depth is a point. It votes for its cell if it is lower than the
//   robot and above the floor by more than `obstacle_m` and by more than three sigma of its height. The
//   vote is 1 if the points fill a quarter of a cell's width and height, and less if a neighbouring cell
//   has more points. A point in a cell that is floor in the same picture is moved along its ray, by up to
//   two sigma of its depth, to a cell that is not: stereo errors are along the ray, and an obstacle's face
//   is not in front of its foot. A point within three sigma of where the floor below it ends in the picture
//   stands there, at that end; and so does a plain face, without depth, between two edges that stand
//   (contact_line.h).
// - Hole. A pixel whose point is below the floor by more than `drop_m`, and three sigma, shows that there
//   is no floor where its ray passes the floor's height: that cell is an obstacle.
// Strays count for nothing: points that those above and below contradict, those that are too few for even a
// low obstacle, and those beyond the floor's end that are lower than what stands there: a rim's depth mixed
// with that of the floor behind it (contact_line.h).
// The eye's tilt, roll and height are taken from the floor's plane where a tenth of the picture shows it: a
// walking robot's posture errs by 0.65 degrees and 4 mm, one sigma: by 4 cm of the floor a metre away.
// A vote's weight is min(1, cell_m / dz), with dz = z^2 / (fx baseline) disparity_error_px, one sigma of
// the depth z. Votes add up as log-odds, so their order is irrelevant until a cell saturates: at 10 as an
// obstacle, at -3, five votes, as floor.
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
  double size_m = 4.0;        // side; the origin is in the middle. 2..2000 cells
  double farthest_m = 1.5;    // maximum distance from the eye along the floor
  double obstacle_m = 0.015;  // objects below this height are no obstacles
  double drop_m = 0.03;       // what is seen so far below the floor is a hole, or beyond an edge
  double robot_m = 0.36;      // what is higher than this passes above the robot
  // Points nearer to the foot's middle are the robot's own body; obstacles there are not cleared either.
  double own_m = 0.13;
  double disparity_error_px = 0.2;  // one sigma
};

struct Cell {
  CellState state = CellState::unknown;
  double confidence = 0;  // 0..1: |2p - 1|, p the probability of an obstacle
};

// A part of the robot's own body that the eyes may see: a capsule around the line from `from` to `to`, foot
// frame (vision/image/frame.h) at the exposure, m.
struct OwnPart {
  Eigen::Vector3d from, to;
  double radius_m = 0;
};

// State of a rectangle: free only if all of its cells are floor.
enum class Footprint { free, blocked, unknown };

struct MapCounts {
  std::uint64_t updates = 0;
  std::uint64_t without_posture = 0;  // refused
  std::uint64_t out_of_order = 0;     // refused
};

class LocalMap {
 public:
  // Errors: options out of range.
  static Result<LocalMap> make(const LocalMapOptions& options = {});

  // Enters one pair's floor and depth. `info` (as a rule planes.info) holds camera and posture;
  // `map_from_foot` is the pose of the foot at the exposure, its sole on z = 0. Pixels that show `own`, or
  // lie within 10 px (of 320) of its outline, are no obstacles. After an error only counts() is changed.
  // Errors: the posture at the exposure is not known; the exposure is not later than that of the last
  // update; planes and depth of different exposures or sizes, no camera model, numbers that are not finite.
  Result<void> update(const vision::PlaneSegments& planes, const vision::DepthImage& depth,
                      const vision::FrameInfo& info,
                      const Eigen::Isometry3d& map_from_foot = Eigen::Isometry3d::Identity(),
                      std::span<const OwnPart> own = {});
  void clear();
  // Old evidence counts less: all log-odds times `share`, 0..1.
  void fade(double share);

  // Cells by number; 0 is at the rear right corner. Outside the map all is unknown.
  int cells() const { return cells_; }  // along each side
  const LocalMapOptions& options() const { return options_; }
  Cell cell(int x, int y) const;
  Cell at(double x_m, double y_m) const { return cell(number(x_m), number(y_m)); }
  int number(double m) const;     // of the cell in which this coordinate lies
  double middle(int cell) const;  // m
  // As cell(), but what only a single picture took for an obstacle is unknown.
  CellState certain(int x, int y) const;
  CellState certain_at(double x_m, double y_m) const { return certain(number(x_m), number(y_m)); }
  // Log-odds of an obstacle; 0 where unknown.
  double log_odds(int x, int y) const;

  // State of the rectangle of `length_m` along its forward axis and `width_m`, with its centre at `pose`
  // in the map. Cells count whose middle is inside.
  Footprint footprint(const Eigen::Isometry2d& pose, double length_m, double width_m) const;

  // Floor green, obstacle red, unknown grey; paler where the confidence is lower. Forward is up, one pixel a
  // cell.
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
  std::vector<std::int16_t> odds_;  // in steps of kStep
  // Of the current update().
  std::vector<std::uint32_t> seen_;    // number of the update that last showed floor here
  std::vector<float> hits_;            // obstacles' votes
  std::vector<std::uint16_t> points_;  // points of obstacles
  std::vector<std::uint32_t> touched_;
  std::vector<int> row_u_, row_v_, row_vote_;  // of a row of cells
  ContactLine contact_;
  std::vector<float> row_up_;      // of a row of pixels: height, m
  std::vector<std::uint8_t> own_;  // by pixel, 1: shows the robot itself
};

}  // namespace kaz::map
