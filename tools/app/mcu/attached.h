// What `kaz mcu run` puts around the chip: a netlist, and a recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/h8s/debug/vcd.h"
#include "sim/h8s/netlist/netlist.h"
#include "tools/app/base/output_file.h"

namespace kaz::tools {

class Attached {
 public:
  // Empty paths: none. `chip` must outlive this.
  Result<void> open(h8s::Chip& chip, const std::string& netlist, const std::string& vcd,
                    const std::vector<std::string>& signals, double crystal_hz);
  // Completes the recording and prints the netlist's conflicts on standard error.
  Result<void> close();

 private:
  std::unique_ptr<h8s::Netlist> netlist_;
  std::optional<OutputFile> vcd_;
  std::ofstream vcd_stream_;
  std::unique_ptr<h8s::VcdRecorder> recorder_;
};

}  // namespace kaz::tools
