// `kaz calibrate joints`: calibrates potentiometers by stops, gravity and symmetry, or by gauge.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"
#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct JointCalibrationOptions {
  // Uses robot and address; for the virtual robot also world, mcu, image, sensors, imu, supply_volts and
  // seed.
  BackendOptions backend;
  std::string only;                // "stops", "floor", "gauge"; empty: stops, then floor
  std::vector<std::string> gauge;  // NAME=DEGREES or all=DEGREES
  double gauge_error_deg = 0.5;    // one standard deviation
  std::string memory;    // file of the virtual board's flash, read if it exists, and written
  std::string out;       // folder for the report; none if empty
  bool yes = false;      // no confirmation at a port
  bool dry_run = false;  // prints the motions and opens nothing
  bool store = true;     // false: leaves the board unchanged
  bool json = false;     // prints the result to standard output, and no progress
};

// Prints the report and stores the calibration. The outcome is a failure, and the board stays unchanged, if a
// joint to calibrate has no good reading. After an interrupt or another error the board also stays unchanged;
// `out` then contains the readings so far.
Result<Outcome> calibrate_joints(const JointCalibrationOptions& options);

}  // namespace kaz::tools
