// `kaz sim --bus`: a servo bus with a robot's servos for other processes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct ServeBusOptions {
  std::string protocol;    // "feetech" or "dynamixel"
  std::string serial;      // where to put the link to the port
  std::string robot_file;  // URDF, with bus.json beside it
  std::string world = "empty";
  std::string dynamics = "reduced";
  bool suspended = false;              // by its trunk, as in a stand
  std::optional<double> supply_volts;  // instead of bus.json's
};

// Runs until SIGINT, SIGTERM or SIGHUP, which are its normal end.
Result<bool> serve_bus(const ServeBusOptions& options);

}  // namespace kaz::tools
