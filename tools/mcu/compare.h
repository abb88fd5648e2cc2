// `kaz mcu compare`: compares the native servo code with the emulated h8 firmware.
// SPDX-License-Identifier: Apache-2.0
// Compares only the servo's tick, or whole boards on the line.
#pragma once

#include "shared/base/result.hpp"
#include "sim/mcu/compare.h"
#include "sim/mcu/compare_wire.h"

namespace kaz::tools {

// Both functions print the report, as JSON if `json` is true, and return whether native and h8 are equal. If
// `image_path` of the options is empty, the installed firmware is used.
Result<bool> compare_ticks(sim::CompareOptions options, bool json);
Result<bool> compare_on_wire(sim::WireOptions options, bool json);

}  // namespace kaz::tools
