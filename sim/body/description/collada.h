// Reads COLLADA meshes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/body/description/mesh_file.h"

namespace kaz::sim {

// Reads the geometries of the visual scene of a .dae file: triangles, polylists and polygons with
// their nodes' transforms, in m. As in ROS, the up axis of the file is ignored. Materials, controllers and
// references to other files are not read. Returns Fault::usage with file and line if the file is invalid.
Result<MeshTriangles> read_collada(const std::string& path, const Eigen::Vector3d& scale);

}  // namespace kaz::sim
