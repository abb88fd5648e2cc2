// Contact line: finds the row in which objects touch the floor, for each column of a picture. Internal to
// host/map.
// SPDX-License-Identifier: Apache-2.0
//
// At 1 m, the error of the measured depth is a few centimeters, and a face without texture has depth only at
// its edges. But the row of the pixel in which an object touches the floor is exact to a pixel. Let r be the
// ray through this pixel (map frame), and let h be the height of the eye. The ray intersects the floor at the
// horizontal distance h |r_xy| / -r_z from the eye.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "vision/planes/plane_segments.h"

namespace kaz::map {

// Call begin() first. For each row, from the bottom row to the top row, call enter_row(), then the functions
// for the points of this row. At the end, call plain_faces().
class ContactLine {
 public:
  // A column of a face without texture. The column has no depth, but the columns at both ends of the face
  // have points.
  struct Filled {
    Eigen::Vector3f ray;  // ray through the end of the floor, map frame; scaled to a depth of 1
    // Horizontal distance from the eye to the foot of the face.
    float distance_m = 0;
    float votes = 0;  // interpolated between the columns at the ends of the face
    int points = 0;
  };

  // `floor[label]`: true if the label is floor. `planes` and `floor` must stay valid until the last call for
  // this picture.
  void begin(const vision::PlaneSegments& planes, const std::array<bool, 256>& floor,
             const Eigen::Isometry3d& map_from_eye);
  // Enters the floor pixels of row `v`. Enter the rows from the bottom row to the top row.
  void enter_row(int v);
  // Returns the horizontal distance (m) from the eye to the end of the floor in column `u`, in the rows
  // entered so far. Returns 0 if no entered pixel of the column is floor.
  float distance(int u) const;
  // Adds a point of the current row. The point must belong to an object that stands at the end of the floor
  // in column `u`. `height_m`: height of the point above the floor.
  void add(int u, float votes, float height_m);
  // Returns whether the depth of a point of the current row is a mixture of the depths of an object's rim and
  // of the background. Precondition: the point is farther away than the end of the floor below the point. If
  // points of an object at this end of the floor were added, a point lower than the object counts as mixed.
  // If no such points were added, the distance of the point from this end of the floor decides. The point
  // counts as mixed if this distance is larger than the assumed depth of objects.
  bool mixed(int u, float distance_m, float height_m) const;

  // Fills faces without texture. Such a face is a gap of more than `stride` px between two columns with added
  // points. In such a gap, the floor must end along a straight line. Above this line, up to the height
  // `low_m`, there must be neither floor nor pixels of `own`. The returned reference is valid until the next
  // call.
  const std::vector<Filled>& plain_faces(int stride, double low_m,
                                         const std::vector<std::uint8_t>& own);

 private:
  struct Column {
    int floor_row = -1;  // highest row of the column that is floor, so far
    int row = -1;        // row where the floor ends below the first point
    float votes = 0;
    int points = 0;
    int top_row = -1;  // row where the floor ends below the newest points
    float top_m = 0;   // largest height of the points at top_row
    float foot_m = 0;  // distance() to the end of the floor at top_row
  };
  bool floor_at(int u, int v) const;
  Eigen::Vector3f ray_above(int u, int v) const;
  float distance_above(int u, int v) const;
  // Returns the row in which the floor ends, within kStraight_px of `expected`. Returns -1 if there is no
  // such row, or if floor or `own` pixels are among the `rows` pixels above that row.
  int end_near(int u, double expected, int rows, const std::vector<std::uint8_t>& own) const;

  const vision::PlaneSegments* planes_ = nullptr;
  const std::array<bool, 256>* floor_ = nullptr;
  Eigen::Isometry3d eye_ = Eigen::Isometry3d::Identity();
  std::vector<Column> columns_;
  std::vector<Filled> filled_;
};

}  // namespace kaz::map
