// Selects the directions in which the robot's eyes see the most unknown floor.
// SPDX-License-Identifier: Apache-2.0
//
// Greedy next-best-view selection: repeatedly chooses the candidate whose view contains the largest weighted
// area of unknown floor. Unknown floor near the path has the full weight; other unknown floor has a smaller
// weight. Floor in a chosen view no longer counts for the other candidates. The selection stops when no view
// contains enough unknown floor. A view ends at the first obstacle of the map.
//
// Map frame. Units: m, rad; directions are relative to Viewpoint::heading_rad, positive to the left.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/map/local_map.h"

namespace kaz::map {

struct Viewpoint {
  Eigen::Vector2d eye{0, 0};
  double heading_rad = 0;                     // heading of direction 0
  double half_view_rad = 0;                   // half the angle of one view
  double nearest_m = 0.25, farthest_m = 1.2;  // range of the visible floor
};

// Returns the selected candidates, the best candidate first. `path`: corners of the path to be walked. If
// there are fewer than two corners, all unknown floor has equal weight. `worth_m2`: smallest weighted area of
// unknown floor for which a view is chosen.
std::vector<double> directions_worth_a_look(const LocalMap& map, const Viewpoint& from,
                                            std::span<const double> candidates,
                                            std::span<const Eigen::Vector2d> path,
                                            double worth_m2 = 0.03);

}  // namespace kaz::map
