// `kaz bus scan`: finds the servos on a bus and their baud rates, and checks them and the wiring.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"

namespace kaz::tools {

struct BusScanOptions {
  std::string robot;     // for parse_bus(); if it contains a protocol, `protocol` must be empty
  std::string protocol;  // "feetech", "dynamixel"; empty: the one in `robot`, or both
  std::vector<long> bauds;
  int first_id = 0, last_id = 252;
  int readings = 20;
  bool json = false;
};

// Prints the servos. Status 1: no servo found, or a problem found. Status 3: no problem found, but this
// machine was too late to judge all ids.
Result<Outcome> run_bus_scan(const BusScanOptions& options);

}  // namespace kaz::tools
