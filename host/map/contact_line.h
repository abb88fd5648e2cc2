// Contact line: where objects meet the floor in a picture, column by column. Internal to host/map.
// SPDX-License-Identifier: Apache-2.0
//
// Depth errs by centimeters at 1 m, and a plain face has depth only at its edges. But the row in which an
// object meets the floor is exact to a pixel. Its ray meets the floor at the horizontal distance h |r_xy| /
// -r_z, with the height h of the eye and the ray r, map frame.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "vision/image/frame.h"
#include "vision/planes/plane_segments.h"

namespace kaz::map {

// Call begin(), then enter_row() for each row from the lowest to the highest, with the points of the row
// after it. At the end, call plain_faces().
class ContactLine {
 public:
  // A column without depth between two columns with standing points.
  struct Filled {
    Eigen::Vector3f ray;  // map frame; its depth is 1 in the optical frame
    // Horizontal distance from the eye to the foot of the face.
    float distance_m = 0;
    float votes = 0;  // interpolated between the columns at the ends of the face
    int points = 0;
  };

  // `floor`: true for labels that are floor. `planes` and `floor` must outlive the use.
  void begin(const vision::PlaneSegments& planes, const std::array<bool, 256>& floor,
             const Eigen::Isometry3d& map_from_eye);
  // Enters the floor pixels of row `v`. Call it from the lowest row to the highest.
  void enter_row(int v);
  // Horizontal distance (m) from the eye to the end of the floor in column `u`, among the rows entered so
  // far; 0 if no pixel of the column is floor.
  float distance(int u) const;
  // Adds a point of the current row that stands at the end of the floor in its column, `height_m` above the
  // floor.
  void add(int u, float votes, float height_m);
  // Returns whether the depth of a point of the current row is mixed from a rim and its background. The
  // point must be farther away than the end of the floor below it. If an object was added that stands at this
  // end of the floor, a point lower than the object is mixed. If no such object was added, a point is mixed
  // if its distance beyond the floor's end exceeds the depth of objects.
  bool mixed(int u, float distance_m, float height_m) const;

  // Fills plain faces between neighboring columns with standing points that are more than `stride` apart.
  // Between them, the floor must end along a straight line. Above this line, up to the height `low_m`,
  // there must be neither floor nor pixels of `own`. The result is valid until the next call.
  const std::vector<Filled>& plain_faces(int stride, double low_m,
                                         const std::vector<std::uint8_t>& own);

 private:
  struct Column {
    int floor_row = -1;  // highest so far
    int row = -1;        // row of the floor below the first point
    float votes = 0;
    int points = 0;
    int top_row = -1;  // row of the floor below the newest points
    float top_m = 0;   // largest height of these points
    float foot_m = 0;  // distance() there
  };
  bool floor_at(int u, int v) const;
  Eigen::Vector3f ray_above(int u, int v) const;
  float distance_above(int u, int v) const;
  // Returns the row of the floor's end within kStraight_px of `expected` if the `rows` above it are neither
  // floor nor `own`. Otherwise returns -1.
  int end_near(int u, double expected, int rows, const std::vector<std::uint8_t>& own) const;

  const vision::PlaneSegments* planes_ = nullptr;
  const std::array<bool, 256>* floor_ = nullptr;
  Eigen::Isometry3d eye_ = Eigen::Isometry3d::Identity();
  std::vector<Column> columns_;
  std::vector<Filled> filled_;
};

}  // namespace kaz::map
