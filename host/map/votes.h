// One picture's view of the map's cells, and what a vote is worth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "host/map/local_map.h"

namespace kaz::map {

// Log-odds are kept in whole steps, so that their sum does not depend on the order of updates.
inline constexpr double kStep = 0.01;
inline constexpr double kFloorVote = 0.6;     // log-odds: a pixel of the segment is floor in 65 %
inline constexpr double kObstacleVote = 1.2;  // 77 %: an obstacle overseen costs more
inline constexpr double kMost = 10;           // a cell is full: it has to be able to change
inline constexpr double kKnown = 0.1;         // log-odds: below that a cell is unknown
inline constexpr double kFullAt = 4;          // a whole vote is a quarter of a cell full of pixels
inline constexpr float kUneven = 1.6F;        // 1 / share of its neighbour's points that is whole

struct LocalMap::View {
  View(const vision::CameraModel& model, const Eigen::Isometry3d& map_from_eye,
       const LocalMapOptions& options)
      : camera(model), eye(map_from_eye), fb(model.fx * model.baseline_m) {
    weight_z2 = options.cell_m * fb / options.disparity_error_px;
  }

  const vision::CameraModel& camera;
  Eigen::Isometry3d eye;
  double fb;         // px m
  double weight_z2;  // m^2: depth squared at which depth errs by a cell
};

}  // namespace kaz::map
