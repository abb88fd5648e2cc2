// Contact points of two convex polyhedra that touch with faces.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "sim/body/description/convex_hull.h"

namespace kaz::sim {

// A convex polyhedron in the world frame. The references must outlive the object.
struct Polyhedron {
  const ConvexHull* hull = nullptr;  // null: a box
  const Eigen::Vector3d& half;       // half lengths of the box, m
  const Eigen::Matrix3d& axes;       // orientation
  const Eigen::Vector3d& at;         // position, m
};

// A contact point (world frame, m) and its depth of penetration (m).
using DeepPoint = std::pair<Eigen::Vector3d, double>;

// Finds the area in which two touching polyhedra overlap. One face is the face that the other polyhedron
// penetrates. The opposed face of the other polyhedron is clipped by the sides of that face (I. Sutherland
// and G. Hodgman, Reentrant polygon clipping, CACM 17(1), 1974).
//
// `normal`: in: unit vector from `b` to `a`, an estimate. Out: the normal of the face.
// `depth`: depth of penetration, m.
// `points`: the corners of the area that penetrate.
// Returns false, and leaves `normal` unchanged, if no face has this depth. An example is a contact of two
// edges.
bool face_contact(const Polyhedron& a, const Polyhedron& b, double depth, Eigen::Vector3d& normal,
                  std::vector<DeepPoint>& points);

// Returns the indices of at most four points that span the area of `points`, which must not be empty. They
// are the deepest point, the farthest from it, and the farthest on both sides of their line. The rest is
// -1.
std::array<int, 4> spanning_points(std::span<const DeepPoint> points,
                                   const Eigen::Vector3d& normal);

}  // namespace kaz::sim
