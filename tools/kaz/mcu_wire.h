// `kaz mcu compare --wire`: the two engines as whole boards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "shared/base/result.hpp"
#include "sim/mcu/compare_wire.h"

namespace kaz::tools {

struct WireArguments {
  bool wire = false;
  sim::WireOptions options;
};

void add_wire_options(CLI::App& verb, WireArguments& arguments);
// Prints the report. Returns whether the boards are equal.
Result<bool> compare_on_wire(sim::WireOptions options, bool json);

}  // namespace kaz::tools
