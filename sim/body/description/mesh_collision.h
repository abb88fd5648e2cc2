// Convex collision shape in place of a mesh.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// Reads a mesh file and returns the shape that replaces it, in the frame of the mesh. `scale`: factor for
// each axis. A mesh in a plane gets a box instead of a hull. Errors: as read_mesh().
Result<CollisionShape> mesh_collision(const std::string& path, const Eigen::Vector3d& scale,
                                      MeshCollision wanted);

// Shapes in place of the meshes of one robot. Robots repeat meshes, such as those of their servos: each file
// is read once, and its hull is shared.
class MeshShapes {
 public:
  explicit MeshShapes(MeshCollision wanted) : wanted_(wanted) {}
  // As mesh_collision().
  Result<CollisionShape> around(const std::string& path, const Eigen::Vector3d& scale);

 private:
  MeshCollision wanted_;
  std::map<std::string, CollisionShape> known_;  // by path and scale
};

}  // namespace kaz::sim
