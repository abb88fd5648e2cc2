// Names of Kaz's joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "shared/board/board.h"

namespace kaz::sim {

// Returns the names of the joints in the order of shared/board/joints.def.
const std::array<std::string, KZ_JOINTS>& joint_names();

}  // namespace kaz::sim
