// Which directions are worth a look: where floor that was not seen yet would come into view.
// SPDX-License-Identifier: Apache-2.0
//
// Next best view, greedy: of the candidates the one whose view holds most unknown floor, weighted by how near
// to the path it is; what it shows counts for no other; until none is worth the time. A view ends at the
// first obstacle of the map.
//
// Frame: the map's. m, rad; directions + to the left of `heading_rad`.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/map/local_map.h"

namespace kaz::map {

struct Viewpoint {
  Eigen::Vector2d eye{0, 0};
  double heading_rad = 0;                     // of direction 0
  double half_view_rad = 0;                   // of one look
  double nearest_m = 0.25, farthest_m = 1.2;  // of the floor that it shows
};

// Of `candidates` those worth a look, the best first. `path`: corners of the way that is to be walked, two or
// more; else all unknown floor counts alike. `worth_m2`: the least weighted area of unknown floor.
std::vector<double> directions_worth_a_look(const LocalMap& map, const Viewpoint& from,
                                            std::span<const double> candidates,
                                            std::span<const Eigen::Vector2d> path,
                                            double worth_m2 = 0.03);

}  // namespace kaz::map
