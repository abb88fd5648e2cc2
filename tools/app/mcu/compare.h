// `kaz mcu compare`: compares native with h8, for the servo's tick alone or for whole boards on the line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "sim/mcu/compare.h"
#include "sim/mcu/compare_wire.h"

namespace kaz::tools {

// Print the report, as JSON if `json`, and return whether native and h8 are equal. `image_path`: the
// installed firmware if empty.
Result<bool> compare_ticks(sim::CompareOptions options, bool json);
Result<bool> compare_on_wire(sim::WireOptions options, bool json);

}  // namespace kaz::tools
