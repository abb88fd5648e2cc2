// Checks the path and the format of a mesh file that is listed in a robot file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Returns the absolute path of a mesh file, with symbolic links resolved. `name` is the path as written in
// the robot file. It is relative to the folder of the robot file, absolute, or a URI:
// - package:///PATH starts at the folder of the robot file.
// - package://NAME/PATH and model://NAME/PATH start in the package NAME. This is the robot's package if it
//   has this name, else the first folder of KAZ_MESH_PATH that is named NAME or contains a folder NAME.
//
// Robot files are untrusted and must not make the program read, draw or serve arbitrary files. Therefore the
// mesh must be in the robot's package or in a folder that the environment variable KAZ_MESH_PATH lists. The
// format of KAZ_MESH_PATH is FOLDER[:FOLDER...]. The package is the closest parent folder that contains a
// package.xml. If no parent folder contains a package.xml, the package is the folder of the robot file. A
// missing mesh file is not an error of this function. The error message is a sentence fragment that the
// caller completes.
Result<std::string> mesh_path(const std::string& robot_path, const std::string& name);

// Returns whether `path` is `folder` or lies below it. Both must be without symbolic links and "..".
bool is_inside(const std::filesystem::path& path, const std::filesystem::path& folder);

// Returns the existing folders that an environment variable lists (FOLDER[:FOLDER...]), with symbolic links
// resolved.
std::vector<std::filesystem::path> listed_folders(const char* variable);

bool mesh_exists(const std::string& path);

// Returns nullopt if extension, size and basic structure of a mesh file are valid. For an invalid file,
// returns a sentence fragment with the error; the caller completes the sentence. Only the renderer parses the
// triangles (sim/render/model/mesh.h).
std::optional<std::string> mesh_error(const std::string& path);

}  // namespace kaz::sim
