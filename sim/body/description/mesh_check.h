// Checks path and format of a mesh file that a robot file names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Returns the absolute path of a mesh that a robot file names relative to itself, with symbolic links
// resolved. Robot files are untrusted and must not make the program read, draw or serve arbitrary files. So
// the mesh must be in the robot's package, or in a folder of the environment variable KAZ_MESH_PATH
// (FOLDER[:FOLDER...]). The package is the closest parent folder with a package.xml, else the folder of the
// robot file. A missing file is not an error here. The error message is a sentence fragment that the caller
// completes.
Result<std::string> mesh_path(const std::string& robot_path, const std::string& name);

// Returns nullopt if extension, size and basic structure of a mesh file are valid. Otherwise returns the
// error, a sentence fragment that the caller completes. Only the renderer parses the contents
// (sim/view/model/mesh.h).
std::optional<std::string> mesh_error(const std::string& path);

}  // namespace kaz::sim
