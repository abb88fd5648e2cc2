// `kaz bus scan`: finds the servos on a bus and their baud rates, and checks the servos and the wiring.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/base/exit_status.h"

namespace kaz::tools {

struct BusScanOptions {
  // Bus and port, as for parse_bus(); if `robot` contains a protocol, `protocol` must be empty.
  std::string robot;
  // "feetech" or "dynamixel"; empty: the protocol in `robot`, or both protocols.
  std::string protocol;
  std::vector<long> bauds;
  int first_id = 0, last_id = 252;
  int readings = 20;
  bool json = false;
};

// Scans the bus and prints the servos that it finds. Exit status 1: no servo was found, or a problem was
// found. Exit status 3: no problem was found, but this machine was too late to judge all ids.
Result<ExitStatus> run_bus_scan(const BusScanOptions& options);

}  // namespace kaz::tools
