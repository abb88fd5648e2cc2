// Convex collision shape in place of a mesh.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mesh_collision.h"

#include <algorithm>
#include <memory>
#include <span>
#include <sstream>
#include <tuple>
#include <vector>

#include "sim/body/description/convex_hull.h"
#include "sim/body/description/mesh_file.h"

namespace kaz::sim {
namespace {

// The convex shape in place of a mesh, and its pose in the mesh's frame.
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
    // Each corner belongs to about six triangles.
    std::sort(centered.begin(), centered.end(), [](const auto& a, const auto& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    });
    centered.erase(std::unique(centered.begin(), centered.end()), centered.end());
    shape.hull = convex_hull(centered);
    shape.kind = Shape::Kind::hull;
    if (shape.hull) return {shape, Eigen::Isometry3d(Eigen::Translation3d(center))};
  }
  const EnclosingBox box = enclosing_box(points);
  shape.kind = Shape::Kind::box;
  shape.size = box.lengths;
  return {shape, box.at};
}

}  // namespace

Result<CollisionShape> mesh_collision(const std::string& path, const Eigen::Vector3d& scale,
                                      MeshCollision wanted) {
  const auto mesh = KAZ_TRY(read_mesh(path, scale));
  CollisionShape out;
  std::tie(out.shape, out.in_link) = shape_around(mesh.corners, wanted);
  if (!out.shape.hull) return out;
  auto hull = std::make_shared<ConvexHull>(*out.shape.hull);
  hull->mesh = {path, scale, -out.in_link.translation()};
  out.shape.hull = std::move(hull);
  return out;
}

Result<CollisionShape> MeshShapes::around(const std::string& path, const Eigen::Vector3d& scale) {
  std::ostringstream key;
  key << path << ' ' << scale.transpose();
  auto found = known_.find(key.str());
  if (found == known_.end())
    found = known_.emplace(key.str(), KAZ_TRY(mesh_collision(path, scale, wanted_))).first;
  return found->second;
}

}  // namespace kaz::sim
