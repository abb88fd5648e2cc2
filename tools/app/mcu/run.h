// `kaz mcu run`: runs an image on the bare chip, without a board.
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
  std::optional<std::int64_t> max_states;  // empty: one second on the chip, no limit with `flat`
  std::optional<std::int64_t> max_insns;   // for `flat` only
  bool flat = false;
  bool semihost = false;
  bool count = false;  // prints instructions and states to standard error
  // For the chip only. Empty: start at the reset vector. "image": at the image's entry. Else an address.
  std::string entry;
  int mode = 2;         // mode pins
  int ram_fill = 0xa5;  // value of each byte of RAM at power-on
  double crystal_hz = 18.432e6;
  std::string input;                               // file with bytes for RxD0; "-": standard input
  std::string netlist, vcd;                        // files; empty: none
  std::vector<std::string> signals{"pins", "pc"};  // signals in the VCD file
  McuDebugOptions debug;                           // for the chip only
  bool json = false;
};

// Prints bytes that the program sends on SCI0 to standard output, and the summary to standard error. The
// outcome is a failure if the chip stopped with an error. All input pins are low except RxD0, which idles.
Result<Outcome> run_mcu(const McuRunOptions& options);
// Runs the image on the flat machine (flat.cpp). With semihosting the outcome is the program's exit status,
// or 125 without one; a line on standard error then states the reason.
Result<Outcome> run_flat(const McuRunOptions& options, const h8s::Image& image);

}  // namespace kaz::tools
