// Camera view of one update of the map, and the weights of votes. Internal to host/map.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "host/map/local_map.h"

namespace kaz::map {

// Log-odds are integers in units of kStep, so that their sum does not depend on the order of updates.
inline constexpr double kStep = 0.01;
// Log-odds of p = 0.65: the probability that a pixel of the floor segment is floor.
inline constexpr double kFloorVote = 0.6;
// Log-odds of p = 0.77. It is more than a vote for floor, because a missed obstacle costs more.
inline constexpr double kObstacleVote = 1.2;
// Largest difference in disparity between an obstacle point and those above and below it. Block matching
// scatters single points behind the rim of an object in front of the floor.
inline constexpr float kSmooth_px = 1;
// Minimum number of obstacle points in a cell and its eight neighbors; fewer points are strays. A box 2 cm
// high at 1.2 m has about six points.
inline constexpr int kMinPoints = 4;
// Near the robot, the minimum number of points is larger: this share of the points on a face that is as wide
// as a cell and as high as the lowest obstacle.
inline constexpr double kMinShare = 0.3;
// Largest difference, in sigmas of disparity, between a point and the end of the floor below it, if the
// point stands there.
inline constexpr float kContactSigmas = 3;
// Sides of the picture, as a share of its width, in which floor does not count. They are twice as wide as
// the search range of the floor's edges (vision/planes/floor_edges.h, 8 px of 320). A thing that shows less
// at a side is labeled floor.
inline constexpr double kSide = 16.0 / 320;
// Saturation, so that a cell can change again. Floor saturates after five votes, because pictures from one
// place repeat each other's errors. Floor labeled from afar must not outlast later views from close by.
inline constexpr double kMaxOdds = 10, kMaxFloorOdds = 3;
// Log-odds (three obstacle votes) from which floor beside the feet does not clear a cell.
inline constexpr double kKeptBeside = 3.6;
inline constexpr double kKnown = 0.1;  // a cell is unknown if its log-odds have a smaller magnitude
// A full vote needs a quarter of the pixels that fill a cell.
inline constexpr double kFullAt = 4;
// A cell's vote is not reduced if its votes times this factor reach those of the strongest neighbor.
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
