// Finds elements of a world file that this simulator does not take, so that none is
// ignored in silence.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Elements, numbers, names and masses, against the subset of docs/reference/worlds.md: an element that is not
// taken is an error, so that none is ignored in silence.
Result<void> check_sdf(const std::string& path);

}  // namespace kaz::sim
