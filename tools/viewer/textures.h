// Textures of the renderer as files for the viewer page.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "shared/base/result.hpp"
#include "tools/viewer/entry.h"

namespace kaz::viewer {

// Returns files by path: "/textures/NAME.png" for each name in sim::kTextureNames, and "/textures.json". The
// JSON file contains {NAME: LENGTH}. LENGTH is the length in m of one period of the texture on a surface. Row
// 0 of a texture's picture is at the texture coordinate v = 0. Each call returns the same bytes.
Result<std::map<std::string, ServedFile>> texture_files();

}  // namespace kaz::viewer
