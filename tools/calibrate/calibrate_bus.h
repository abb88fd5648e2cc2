// `kaz calibrate joints` for a servo bus: measures joint ranges and prevents positions that wrap around.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/base/exit_status.h"
#include "tools/run/backend_options.h"

namespace kaz::tools {

struct BusCalibrationOptions {
  BackendOptions backend;  // only robot and robot_file are used
  double seconds = 120;    // longest time that the user has to turn the joints
  std::string out;         // folder for result.json; empty: no file is written
  bool release = false;    // switches the servos' torque off first
  bool yes = false;        // writes the changes without asking for confirmation
  bool store = true;       // false: only prints the changes
  bool json = false;
};

// Reads positions while the user turns each joint from stop to stop. Shifts each joint's range so that no
// position in the range wraps around, and prints the changes. Then writes the changes to the servos' EEPROM
// and to bus.json. If a joint has no good range, the outcome is a failure and nothing is written. After an
// interrupt or an error nothing is written, or all writes are undone.
Result<ExitStatus> calibrate_bus_joints(const BusCalibrationOptions& options);

}  // namespace kaz::tools
