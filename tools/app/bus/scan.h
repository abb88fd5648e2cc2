// `kaz bus scan`: which servos are on a bus, at which rate, and what is wrong with them or the wire.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"

namespace kaz::tools {

struct BusScanOptions {
  std::string robot;     // as parse_bus() accepts it; with a protocol, `protocol` is empty
  std::string protocol;  // "feetech", "dynamixel"; empty: that of `robot`, or both
  std::vector<long> bauds;
  int first_id = 0, last_id = 252;
  int readings = 20;
  bool json = false;
};

// Prints the servos. Status 1: there are none, or something is wrong; 3: nothing is wrong, but this machine
// was too late to judge all.
Result<Outcome> run_bus_scan(const BusScanOptions& options);

}  // namespace kaz::tools
