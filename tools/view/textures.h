// The renderer's textures as files for the page.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "shared/base/result.hpp"
#include "tools/view/entry.h"

namespace kaz::watch {

// By path: "/textures/NAME.png" for each of sim::kTextureNames, row 0 at v = 0 of the surface, and
// "/textures.json": {NAME: length of one period on a surface, m}. The same bytes in each call.
Result<std::map<std::string, ServedFile>> texture_files();

}  // namespace kaz::watch
