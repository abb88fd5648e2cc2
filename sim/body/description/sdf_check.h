// Validates a world file: unsupported elements are errors, none is silently ignored.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Checks elements, numbers, names and masses against the subset of SDF in docs/reference/worlds.md. Errors
// name file and line.
Result<void> check_sdf(const std::string& path);

}  // namespace kaz::sim
