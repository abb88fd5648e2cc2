// Convex collision shape in place of a mesh.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// Reads a mesh file and returns the shape that replaces it, in the frame of the mesh. `scale`: factor for
// each axis. A mesh in a plane gets a box instead of a hull. Errors: as read_mesh().
Result<CollisionShape> mesh_collision(const std::string& path, const Eigen::Vector3d& scale,
                                      MeshCollision wanted);

}  // namespace kaz::sim
