// `kaz sim --bus`: simulated servo bus of a robot for other processes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServeBusOptions {
  std::string protocol;    // "feetech" or "dynamixel"
  std::string serial;      // path of the symbolic link to the port
  std::string robot_file;  // URDF, with bus.json beside it
  std::string world = "empty";
  std::string dynamics = "reduced";
  bool suspended = false;              // held at the trunk
  std::optional<double> supply_volts;  // instead of the voltage in bus.json
};

// Runs until SIGINT, SIGTERM or SIGHUP, which end it normally.
Result<bool> serve_bus(const ServeBusOptions& options);

}  // namespace kaz::tools
