// Finds elements of a world file that this simulator does not take, so that none is ignored in
// silence. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// The subset of SDF and our own elements in it: docs/worlds.md.
Result<void> check_sdf(const std::string& path);

}  // namespace kaz::sim
