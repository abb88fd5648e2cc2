// Convex shapes in place of meshes in collisions.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mesh_collision.h"

#include <vector>

#include "sim/body/description/convex_hull.h"

namespace kaz::sim {

std::pair<Shape, Eigen::Isometry3d> shape_around(std::span<const Eigen::Vector3d> points,
                                                 MeshCollision wanted) {
  Shape shape;
  if (wanted == MeshCollision::capsule) {
    const EnclosingCapsule capsule = enclosing_capsule(points);
    shape.kind = Shape::Kind::capsule;
    shape.size = {capsule.radius, capsule.length, 0};
    return {shape, capsule.at};
  }
  if (wanted == MeshCollision::hull) {
    // The frame of a mesh may be far from the mesh. Bounding spheres are about the shape's origin.
    const Eigen::Vector3d center = enclosing_box(points).at.translation();
    std::vector<Eigen::Vector3d> centered(points.begin(), points.end());
    for (Eigen::Vector3d& point : centered) point -= center;
    shape.hull = convex_hull(centered);
    shape.kind = Shape::Kind::hull;
    if (shape.hull) return {shape, Eigen::Isometry3d(Eigen::Translation3d(center))};
  }
  const EnclosingBox box = enclosing_box(points);
  shape.kind = Shape::Kind::box;
  shape.size = box.lengths;
  return {shape, box.at};
}

}  // namespace kaz::sim
