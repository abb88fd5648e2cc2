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
#include "tools/base/exit_status.h"
#include "tools/mcu/debug.h"

namespace kaz::tools {

struct McuRunOptions {
  std::string image;
  h8s::LoadOptions load;
  h8s::Engine engine = h8s::Engine::translator;
  // Limit of states to run; empty: one second of the chip's time, or no limit with `flat`.
  std::optional<std::int64_t> max_states;
  std::optional<std::int64_t> max_insns;  // largest number of instructions to run; only with `flat`
  bool flat = false;
  bool semihost = false;
  bool count = false;  // prints the numbers of instructions and states to standard error
  // Start address; not with `flat`. Empty: the reset vector. "image": the entry point of the image. Otherwise
  // an address.
  std::string entry;
  int mode = 2;         // operating mode that the mode pins select
  int ram_fill = 0xa5;  // value of each byte of RAM at power-on
  double crystal_hz = 18.432e6;
  // Path of a file with bytes for the pin RxD0; "-": standard input.
  std::string input;
  std::string netlist, vcd;                        // paths of files; empty: no file
  std::vector<std::string> signals{"pins", "pc"};  // signals in the VCD file
  McuDebugOptions debug;                           // not with `flat`
  bool json = false;
};

// Writes the bytes that the program sends on SCI0 to standard output, and a summary to standard error. The
// outcome is a failure if the chip stopped with an error. All input pins are low except RxD0, which idles.
Result<ExitStatus> run_mcu(const McuRunOptions& options);
// Runs the image on the flat machine (flat.cpp). With semihosting the outcome is the program's exit status.
// If the program ended without exit status, the outcome is 125, and a line on standard error states the
// reason.
Result<ExitStatus> run_flat(const McuRunOptions& options, const h8s::Image& image);

}  // namespace kaz::tools
