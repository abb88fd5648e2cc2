// `kaz calibrate joints` of a robot on a bus of servos: ranges by hand, and positions that do not wrap.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"
#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct BusCalibrationOptions {
  BackendOptions backend;  // robot and robot_file
  double seconds = 120;    // at most, for turning the joints
  std::string out;         // folder for result.json; none if empty
  bool release = false;    // a torque that is on is switched off at the beginning
  bool yes = false;        // write without a question
  bool store = true;       // false: report only
  bool json = false;
};

// Reads positions while somebody turns each joint from stop to stop, places each range so that it does not
// wrap, shows what that writes, and writes it to the servos' EEPROM and to bus.json. A joint without a good
// range is a failure, and nothing is written. So it is after an interrupt or an error, or it is taken back.
Result<Outcome> calibrate_bus_joints(const BusCalibrationOptions& options);

}  // namespace kaz::tools
