// Where the floor's edges really are, and how far from there a map has them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "host/map/local_map.h"
#include "sim/body/description/scene.h"
#include "vision/image/frame.h"

namespace kaz::figure7 {

struct Box {
  Eigen::Isometry3d pose;  // of its middle
  Eigen::Vector3d size;
};

// Those of a world that cannot move, in its frame: the robot's visuals have frames of their own.
std::vector<Box> boxes_of(const sim::Scene& scene);

// A place on the lower edge of a box, where floor ends.
struct EdgePoint {
  Eigen::Vector2d place, outward;  // m; unit, from the box onto the floor
  int seen = 0;                    // pictures that show it
};

// All edges at whole steps of 5 mm; `foot_from_world` takes them into the map's frame.
std::vector<EdgePoint> edge_points(const std::vector<Box>& boxes,
                                   const Eigen::Isometry3d& foot_from_world);

// Counts the points that both eyes see, not nearer than 10 px to the picture's border, no box in
// between. `from_eye` and `boxes` in the same frame as points.
void look(const vision::CameraModel& camera, const Eigen::Isometry3d& from_eye,
          const std::vector<Box>& boxes, std::vector<EdgePoint>& points);

// Pictures that a point has to be in: what was seen but once or twice has no vote to speak of.
inline constexpr int kSeenOften = 3;

// Along each point's normal, from 6 cm before the box towards it: where the map's floor ends, m
// from the true edge, positive before it. Points from `near_m` to `far_m` from the origin that are
// seen in kSeenOften or more pictures; those before which the map has no floor count as 6 cm.
struct EdgeError {
  EdgePoint point;
  double error_m = 0;
};
std::vector<EdgeError> edge_errors(const map::LocalMap& map, const std::vector<EdgePoint>& points,
                                   double near_m, double far_m);

// Of the absolute errors: median, 95th percentile, max; m. `mean_m` with signs.
struct EdgeScore {
  int points = 0;
  double mean_m = 0, median_m = 0, p95_m = 0, max_m = 0;
};
EdgeScore score(const std::vector<EdgeError>& errors);

}  // namespace kaz::figure7
