// True edges of the floor, and distances of a map's edges from the true edges.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "host/map/local_map.h"
#include "sim/body/description/scene.h"
#include "vision/image/frame.h"

namespace kaz::figure7 {

struct Box {
  Eigen::Isometry3d pose;  // pose of the box's center
  Eigen::Vector3d size;
};

// Returns the boxes of a world that cannot move. The poses of the boxes are in the world's frame.
std::vector<Box> boxes_of(const sim::Scene& scene);

// A point on the lower edge of a box, where the floor ends.
struct EdgePoint {
  Eigen::Vector2d place, outward;  // place: m; outward: unit vector from the box onto the floor
  int seen = 0;                    // number of pictures that show the point
};

// Returns points on all edges, 5 mm apart. `foot_from_world` transforms the points into the map's frame.
std::vector<EdgePoint> edge_points(const std::vector<Box>& boxes,
                                   const Eigen::Isometry3d& foot_from_world);

// Increments `seen` of the points that both eyes see at least 10 px inside their pictures and that no box
// hides. `from_eye` and `boxes` are in the frame of the points.
void look(const vision::CameraModel& camera, const Eigen::Isometry3d& from_eye,
          const std::vector<Box>& boxes, std::vector<EdgePoint>& points);

// Smallest number of pictures that must show a point. With fewer pictures the map's cells at this point are
// uncertain.
inline constexpr int kSeenOften = 3;

// Error of the map's edge at one true point, in m. The error is the signed distance along the edge's normal
// to the end of the map's floor, positive outside of the box. The floor's end is searched from 6 cm outside
// to 6 cm inside the box. If the map has no floor 6 cm outside, the error is 6 cm.
struct EdgeError {
  EdgePoint point;
  double error_m = 0;
};
// Returns the errors at points that are `near_m` to `far_m` from the origin. Leaves out points that fewer
// than kSeenOften pictures show.
std::vector<EdgeError> edge_errors(const map::LocalMap& map, const std::vector<EdgePoint>& points,
                                   double near_m, double far_m);

// Median, 95th percentile and maximum of the absolute errors, and their signed mean; m.
struct EdgeScore {
  int points = 0;
  double mean_m = 0, median_m = 0, p95_m = 0, max_m = 0;
};
EdgeScore score(const std::vector<EdgeError>& errors);

}  // namespace kaz::figure7
