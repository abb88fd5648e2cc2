// `kaz calibrate joints` for a servo bus: measures ranges by hand, and prevents wrapping positions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"
#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct BusCalibrationOptions {
  BackendOptions backend;  // uses robot and robot_file
  double seconds = 120;    // maximum time to turn the joints
  std::string out;         // folder for result.json; none if empty
  bool release = false;    // switches the torque off first, if it is on
  bool yes = false;        // writes without confirmation
  bool store = true;       // false: report only
  bool json = false;
};

// Reads positions while the user turns each joint from stop to stop. Places each range so that it does not
// wrap, and prints the changes. Then writes them to the servos' EEPROM and to bus.json. The outcome is a
// failure, and nothing is written, if a joint has no good range. After an interrupt or an error nothing is
// written, or the writes are undone.
Result<Outcome> calibrate_bus_joints(const BusCalibrationOptions& options);

}  // namespace kaz::tools
