// True edges of the floor, and their distance from the edges in a map.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "host/map/local_map.h"
#include "sim/body/description/scene.h"
#include "vision/image/frame.h"

namespace kaz::figure7 {

struct Box {
  Eigen::Isometry3d pose;  // pose of the center
  Eigen::Vector3d size;
};

// Returns the boxes of a world that cannot move, in the world's frame.
std::vector<Box> boxes_of(const sim::Scene& scene);

// A point on the lower edge of a box, where the floor ends.
struct EdgePoint {
  Eigen::Vector2d place, outward;  // m; unit vector from the box onto the floor
  int seen = 0;                    // number of pictures that show it
};

// Returns the points on all edges, 5 mm apart. `foot_from_world` transforms them into the map's frame.
std::vector<EdgePoint> edge_points(const std::vector<Box>& boxes,
                                   const Eigen::Isometry3d& foot_from_world);

// Increments `seen` of the points that both eyes see, at least 10 px inside the picture, and not hidden by a
// box. `from_eye` and `boxes` are in the frame of the points.
void look(const vision::CameraModel& camera, const Eigen::Isometry3d& from_eye,
          const std::vector<Box>& boxes, std::vector<EdgePoint>& points);

// Least number of pictures with a point. Fewer have too little weight in the map.
inline constexpr int kSeenOften = 3;

// Error of the map's edge at one point, in m: where the map's floor ends along the normal, positive outside
// of the box. The search goes from 6 cm outside to 6 cm inside. Without floor at 6 cm the error is 6 cm.
struct EdgeError {
  EdgePoint point;
  double error_m = 0;
};
// Returns the errors at points from `near_m` to `far_m` from the origin that were seen in at least kSeenOften
// pictures.
std::vector<EdgeError> edge_errors(const map::LocalMap& map, const std::vector<EdgePoint>& points,
                                   double near_m, double far_m);

// Median, 95th percentile and maximum of the absolute errors, and their signed mean; m.
struct EdgeScore {
  int points = 0;
  double mean_m = 0, median_m = 0, p95_m = 0, max_m = 0;
};
EdgeScore score(const std::vector<EdgeError>& errors);

}  // namespace kaz::figure7
