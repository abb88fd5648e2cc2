// Checks that a mesh file named in a robot file is readable.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Returns the absolute path, without links, of a mesh that a robot file names relative to itself. A robot
// file may come from anywhere, and must not make the program read, draw or serve files elsewhere. So the
// mesh must be in the robot's package: the closest folder upwards with a package.xml, or else the file's
// own folder. The user can name other folders in KAZ_MESH_PATH (FOLDER[:FOLDER...]). A missing file is no
// error here. The error is the end of a sentence.
Result<std::string> mesh_path(const std::string& robot_path, const std::string& name);

// The error of a mesh file, as the end of a sentence; nullopt if its header is valid. It is read in full
// only where pictures are drawn (sim/view/model/mesh.h).
std::optional<std::string> mesh_error(const std::string& path);

}  // namespace kaz::sim
