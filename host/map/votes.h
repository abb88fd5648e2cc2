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
// Largest difference in disparity between an obstacle point and the points above and below. Block matching
// scatters single points behind the rim of an object in front of the floor.
inline constexpr float kSmooth_px = 1;
// Minimum number of obstacle points in a cell and its eight neighbors; fewer points are strays. A box 2 cm
// high at 1.2 m has about six points.
inline constexpr int kMinPoints = 4;
// Minimum number of obstacle points in a cell near the robot, if larger than kMinPoints. The minimum is a
// share of the number of points on a face that is as wide as a cell and as high as the lowest obstacle.
inline constexpr double kMinShare = 0.3;
// A point stands at the end of the floor below the point if their disparities differ by at most this number
// of sigmas.
inline constexpr float kContactSigmas = 3;
// Width of the strips at both sides of the picture in which floor does not count, as a share of the picture's
// width. The strips are twice as wide as the search range of the floor's edges (vision/planes/floor_edges.h,
// 8 px of 320). An object of which only a narrower part is visible at a side is labeled floor.
inline constexpr double kSide = 16.0 / 320;
// Limits of a cell's log-odds, so that the cell can change again. Floor saturates after five votes, because
// pictures from one place repeat each other's errors. Floor labeled from afar must not outlast later views
// from close by.
inline constexpr double kMaxOdds = 10, kMaxFloorOdds = 3;
// Minimum log-odds (three obstacle votes) of a cell that floor beside the feet does not clear.
inline constexpr double kKeptBeside = 3.6;
inline constexpr double kKnown = 0.1;  // a cell is unknown if its log-odds have a smaller magnitude
// Number of pixels that fill a cell, divided by the number of points that give a full vote.
inline constexpr double kFullAt = 4;
// A cell's vote is not reduced if the cell's votes times this factor reach the votes of the strongest
// neighboring cell.
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
