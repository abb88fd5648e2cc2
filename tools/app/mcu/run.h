// `kaz mcu run`: the bare chip with any image, no board around it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/image/image.h"
#include "sim/h8s/chip/options.h"
#include "tools/app/base/outcome.h"
#include "tools/app/mcu/debug.h"

namespace kaz::tools {

struct McuRunOptions {
  std::string image;
  h8s::LoadOptions load;
  h8s::Engine engine = h8s::Engine::translator;
  std::optional<std::int64_t> max_states;  // chip: one second of it; flat: no limit
  std::optional<std::int64_t> max_insns;   // flat only
  bool flat = false;
  bool semihost = false;
  bool count = false;  // instructions and states, on standard error
  // Chip only. Empty: from the reset vector; "image": from the image's entry; else an address.
  std::string entry;
  int mode = 2;         // of the mode pins
  int ram_fill = 0xa5;  // each byte of RAM when power comes
  double crystal_hz = 18.432e6;
  std::string input;                               // file with bytes for RxD0, "-": standard input
  std::string netlist, vcd;                        // files; empty: none
  std::vector<std::string> signals{"pins", "pc"};  // of the recording
  McuDebugOptions debug;                           // chip only
  bool json = false;
};

// What the program sends on SCI0 goes to standard output, the summary to standard error. Not done
// where the chip stopped on an error. Every input pin is low but RxD0, which idles.
Result<Outcome> run_mcu(const McuRunOptions& options);
// The same on the flat machine (flat.cpp). With semihosting the outcome is the program's status,
// 125 where it has none; one line on standard error then says why.
Result<Outcome> run_flat(const McuRunOptions& options, const h8s::Image& image);

}  // namespace kaz::tools
