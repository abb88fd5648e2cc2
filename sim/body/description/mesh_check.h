// Checks that a mesh file named in a robot file is readable.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace kaz::sim {

// The error of a mesh file, as the end of a sentence; nullopt if its header is valid. It is read in full
// only where pictures are drawn (sim/view/model/mesh.h).
std::optional<std::string> mesh_error(const std::string& path);

}  // namespace kaz::sim
