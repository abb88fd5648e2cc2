// Textures of the renderer as files for the viewer page.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "shared/base/result.hpp"
#include "tools/view/entry.h"

namespace kaz::watch {

// Returns files by path: "/textures/NAME.png" for each name in sim::kTextureNames, and "/textures.json". The
// JSON file contains {NAME: length of one period on a surface, m}. Row 0 of a picture is at v = 0 on the
// surface. Each call returns the same bytes.
Result<std::map<std::string, ServedFile>> texture_files();

}  // namespace kaz::watch
