// Validates a world file. Unsupported elements are errors, so that no element is silently ignored.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Checks elements, numbers, names and masses against the SDF subset in docs/reference/worlds.md. An error
// message names file and line.
Result<void> check_sdf(const std::string& path);

}  // namespace kaz::sim
