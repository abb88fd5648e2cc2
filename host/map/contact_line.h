// Where things meet the floor in a picture, column by column. Internal to host/map.
// SPDX-License-Identifier: Apache-2.0
//
// Depth errs by centimetres a metre away, and a plain face has none but at its edges. The row in which a
// thing meets the floor is exact to a pixel, and its ray meets the floor at the horizontal distance
// h |r_xy| / -r_z, with h the height of the eye and r the ray, map frame.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "vision/image/frame.h"
#include "vision/planes/plane_segments.h"

namespace kaz::map {

class ContactLine {
 public:
  // A column between two that stand, whose own pixels have no depth.
  struct Filled {
    Eigen::Vector3f ray;  // map frame, of depth 1
    float distance_m = 0;
    float votes = 0;  // as of the columns at the face's ends
    int points = 0;
  };

  // `floor`: labels that are floor; all three must outlive the use.
  void begin(const vision::PlaneSegments& planes, const std::array<bool, 256>& floor,
             const Eigen::Isometry3d& map_from_eye);
  // Rows from the lowest to the highest.
  void enter_row(int v);
  // Horizontal distance from the eye at which the floor ends in column u, below the rows to come, m; 0 where
  // none was entered.
  float distance(int u) const;
  // A point of the current row that stands there, at that height.
  void add(int u, float votes, float height_m);
  // Whether a point of the current row, farther from the eye than the floor's end below it, is one that
  // the depth of the rim and of what is behind have mixed: what is there is lower than what stands before
  // it, where that is known; else it is farther beyond the floor's end than things are deep.
  bool mixed(int u, float distance_m, float height_m) const;

  // Between neighbouring columns that stand, `stride` or more apart: a face, if what is between ends the
  // floor along a straight line and has no floor above it up to `low_m`, nor pixels of `own`.
  const std::vector<Filled>& plain_faces(int stride, double low_m,
                                         const std::vector<std::uint8_t>& own);

 private:
  struct Column {
    int floor_row = -1;  // the highest so far
    int row = -1;        // of the floor below the points
    float votes = 0;
    int points = 0;
    int top_row = -1;  // of the floor below the highest of the points
    float top_m = 0;   // its height
    float foot_m = 0;  // distance() there
  };
  bool floor_at(int u, int v) const;
  Eigen::Vector3f ray_above(int u, int v) const;
  float distance_above(int u, int v) const;
  // The row of the floor's end within kStraight_px of `expected` with `rows` above it that are none; -1.
  int end_near(int u, double expected, int rows, const std::vector<std::uint8_t>& own) const;

  const vision::PlaneSegments* planes_ = nullptr;
  const std::array<bool, 256>* floor_ = nullptr;
  Eigen::Isometry3d eye_ = Eigen::Isometry3d::Identity();
  std::vector<Column> columns_;
  std::vector<Filled> filled_;
};

}  // namespace kaz::map
