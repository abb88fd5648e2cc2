// Attaches a netlist and a VCD recording to the chip of `kaz mcu run`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/h8s/debug/vcd.h"
#include "sim/h8s/netlist/netlist.h"
#include "tools/base/output_file.h"

namespace kaz::tools {

class Attached {
 public:
  // Opens the netlist and the VCD file. If a path is empty, that file is not used. `chip` must outlive this
  // object. Fails with Fault::usage for an invalid netlist or signal, else like OutputFile::open().
  Result<void> open(h8s::Chip& chip, const std::string& netlist, const std::string& vcd,
                    const std::vector<std::string>& signals, double crystal_hz);
  // Completes the recording, and prints the conflicts that the netlist detected to standard error.
  Result<void> close();

 private:
  std::unique_ptr<h8s::Netlist> netlist_;
  std::optional<OutputFile> vcd_;
  std::ofstream vcd_stream_;
  std::unique_ptr<h8s::VcdRecorder> recorder_;
};

}  // namespace kaz::tools
