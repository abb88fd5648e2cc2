// `kaz mcu compare`: native beside h8, the servo's tick alone or whole boards on the line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "sim/mcu/compare.h"
#include "sim/mcu/compare_wire.h"

namespace kaz::tools {

// Both print the report, as JSON if `json`, and return whether native and h8 are equal.
// `image_path`: the built firmware if empty.
Result<bool> compare_ticks(sim::CompareOptions options, bool json);
Result<bool> compare_on_wire(sim::WireOptions options, bool json);

}  // namespace kaz::tools
