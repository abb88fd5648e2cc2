// Convex shapes that enclose a mesh, for collisions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace kaz::sim {

// Mesh that a hull encloses.
struct HullMesh {
  // Absolute path. Empty: the hull was not read from a file.
  std::string path;
  // Factor for each axis.
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  // Origin of the mesh in the frame of the hull, m. The axes are parallel.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

// Convex polyhedron with triangular faces, in the arrays that ODE's dGeomSetConvex() expects.
struct ConvexHull {
  std::vector<double> points;  // x, y, z of each vertex, m
  std::vector<double> planes;  // outward unit normal n and offset d of each face: n . p = d, m
  std::vector<unsigned>
      polygons;  // for each face: 3, and the indices of its vertices, counterclockwise

  Eigen::Vector3d point(std::size_t i) const {
    return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
  }
  std::size_t size() const { return points.size() / 3; }

  HullMesh mesh = {};
};

// Returns the convex hull of `points` (Quickhull, by libqhull). A hull with more than 200 vertices is
// replaced by the hull of its extreme vertices in 642 directions. Returns null if the points lie in a plane.
std::shared_ptr<const ConvexHull> convex_hull(std::span<const Eigen::Vector3d> points);

// Box that contains `points`. It is the smaller of two boxes: one along the axes of the points' frame, the
// other along the principal axes of the points. Flat boxes get a thickness of 1 mm.
struct EnclosingBox {
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();  // pose of the center in the points' frame
  Eigen::Vector3d lengths = Eigen::Vector3d::Zero();     // m
};
EnclosingBox enclosing_box(std::span<const Eigen::Vector3d> points);

// Capsule that contains `points`. The capsule's axis is z of `at`, which is the longest axis of the enclosing
// box.
struct EnclosingCapsule {
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  double radius = 0, length = 0;  // m; the length is without the caps
};
EnclosingCapsule enclosing_capsule(std::span<const Eigen::Vector3d> points);

}  // namespace kaz::sim
