// Reads triangles from a mesh file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Triangles, counterclockwise as seen from outside. Triangles without area are left out.
struct MeshTriangles {
  std::vector<Eigen::Vector3d> corners;  // three for each triangle, m
  std::vector<Eigen::Vector3d> normals;  // unit normal at each corner
};

// Reads OBJ (v, vn, f with any polygon), STL (text or binary) or COLLADA (read_collada()). The extension of
// the path selects the format. `scale`: factor for each axis, not 0. A negative factor mirrors the mesh.
// Returns Fault::usage if the file is missing, larger than 256 MiB or invalid, or if it has no triangles.
Result<MeshTriangles> read_mesh(const std::string& path, const Eigen::Vector3d& scale);

}  // namespace kaz::sim
