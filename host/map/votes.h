// Camera view of one update of the map, and the weights of votes. Internal to host/map.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "host/map/local_map.h"

namespace kaz::map {

// Log-odds are integers in units of kStep, so that their sum does not depend on the order of updates.
inline constexpr double kStep = 0.01;
inline constexpr double kFloorVote =
    0.6;  // log-odds of p = 0.65: a pixel of the floor segment is floor
inline constexpr double kObstacleVote =
    1.2;  // log-odds of p = 0.77: missing an obstacle costs more
// Of disparity, between a point of an obstacle and those above and below it: block matching scatters single
// points behind the rim of what stands before the floor.
inline constexpr float kSmooth_px = 1;
// Points in a cell and its eight neighbours: fewer are such strays. Of a box 2 cm high at 1.2 m there are
// some six.
inline constexpr int kMinPoints = 4;
// Near by: this share of the points of a face as wide as a cell and as high as the lowest obstacle.
inline constexpr double kMinShare = 0.3;
// Of disparity, between a point and the floor's end below it, of what stands there.
inline constexpr float kContactSigmas = 3;
// Of the picture's width: twice as far as the floor's edges are looked for (vision/planes/floor_edges.h, 8 px
// of 320). A thing of which a side of the picture shows less is called floor.
inline constexpr double kSide = 16.0 / 320;
// Saturation, so that a cell can change again. Five votes for floor: pictures from one place repeat each
// other's errors, and what was called floor from afar must not outlast what is seen from near by.
inline constexpr double kMaxOdds = 10, kMaxFloorOdds = 3;
// Log-odds, three obstacle votes, from which floor beside the feet does not clear a cell.
inline constexpr double kKeptBeside = 3.6;
inline constexpr double kKnown = 0.1;  // magnitude of log-odds below which a cell is unknown
inline constexpr double kFullAt = 4;   // a full vote needs a quarter of the pixels that fill a cell
inline constexpr float kUneven =
    1.6F;  // 1 / ratio to the strongest neighbour's points that counts as full

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
