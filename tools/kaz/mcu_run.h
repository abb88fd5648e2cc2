// `kaz mcu run`: the bare chip with any image, no board around it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct McuRunOptions {
  std::string image;
  std::int64_t max_states = 18'432'000;  // one second of the chip
  bool trace = false;
  bool json = false;
};

// What the program sends on SCI0 goes to standard output, the summary to standard error. False
// where the chip stopped on an error. Runs at 18.432 MHz; every input pin is low.
Result<bool> run_mcu(const McuRunOptions& options);

}  // namespace kaz::tools
