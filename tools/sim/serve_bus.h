// `kaz sim --bus`: simulates the servo bus of a robot, which other processes can use.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"

namespace kaz::tools {

struct ServeBusOptions {
  std::string protocol;    // "feetech" or "dynamixel"
  std::string serial;      // path of the symbolic link to the port
  std::string robot_file;  // path of a URDF file; its folder must contain bus.json
  std::string world = "empty";
  std::string dynamics = "reduced";
  std::string motor;                   // name in motor.xml; empty: its default motor
  bool suspended = false;              // the robot is held at the trunk
  sim::ReadOptions reading = {};       // how the files of robot and world are read
  bool verbose = false;                // list each element of these files that Kaz does not use
  std::optional<double> supply_volts;  // supply voltage; empty: the voltage in bus.json
};

// Runs until SIGINT, SIGTERM or SIGHUP, which count as a normal end.
Result<bool> serve_bus(const ServeBusOptions& options);

}  // namespace kaz::tools
