// Camera view of one update of the map, and the weights of votes. Internal to host/map.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "host/map/local_map.h"

namespace kaz::map {

// Log-odds are integers in units of kStep, so that their sum does not depend on the order of updates.
inline constexpr double kStep = 0.01;
// Weight of a floor vote: log-odds of p = 0.65, the probability that a pixel of the floor segment is floor.
inline constexpr double kFloorVote = 0.6;
// Weight of an obstacle vote: log-odds of p = 0.77. An obstacle vote counts more than a floor vote, because a
// missed obstacle costs more.
inline constexpr double kObstacleVote = 1.2;
// The disparity of an obstacle point must differ from those of the points above and below by less than this
// value. Reason: block matching scatters single points behind the rim of an object in front of the floor.
inline constexpr float kSmooth_px = 1;
// Minimum number of obstacle points in a cell and its eight neighbors; fewer points are strays. A box 2 cm
// high at 1.2 m has about six points.
inline constexpr int kMinPoints = 4;
// Near the robot, the minimum number of obstacle points is larger than kMinPoints. It is kMinShare times the
// number of points on a small face. This face is as wide as a cell and as high as the lowest obstacle.
inline constexpr double kMinShare = 0.3;
// Compares the disparities of a point and of the end of the floor below the point. The point stands at this
// end if the difference is at most this number of sigmas.
inline constexpr float kContactSigmas = 3;
// Width of the strips at the left and at the right edge of the picture, as a share of the picture's width.
// Floor in these strips does not count. The strips are twice as wide as the search range of the floor's edges
// (vision/planes/floor_edges.h, 8 px of 320). If only a narrow part of an object is visible at a side, this
// part is labeled floor.
inline constexpr double kSide = 16.0 / 320;
// Limits of a cell's log-odds, so that the cell can change again. Floor saturates after five votes. Reason:
// pictures from one place repeat each other's errors. If a distant part is wrongly labeled floor, pictures
// from a shorter distance must be able to correct the label.
inline constexpr double kMaxOdds = 10, kMaxFloorOdds = 3;
// Near the feet, floor votes do not change a cell whose log-odds are above this value (three obstacle votes).
inline constexpr double kKeptBeside = 3.6;
inline constexpr double kKnown = 0.1;  // a cell is unknown if its log-odds have a smaller magnitude
// A cell gets a full vote if its points cover at least 1 / kFullAt of the area of a square with the side
// `cell_m`.
inline constexpr double kFullAt = 4;
// A cell's vote is reduced if the votes of the strongest neighboring cell exceed the cell's votes times this
// factor.
inline constexpr float kUneven = 1.6F;

struct LocalMap::View {
  View(const vision::CameraModel& model, const Eigen::Isometry3d& map_from_eye,
       const LocalMapOptions& options)
      : camera(model), eye(map_from_eye), fb(model.fx * model.baseline_m) {
    weight_z2 = options.cell_m * fb / options.disparity_error_px;
  }

  const vision::CameraModel& camera;
  Eigen::Isometry3d eye;
  double fb;         // focal length times baseline, px m
  double weight_z2;  // m^2: squared depth at which the depth error is one cell
};

}  // namespace kaz::map
