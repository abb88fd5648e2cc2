// `kaz calibrate joints`: the potentiometers of a robot against stops, gravity and symmetry, or by a gauge.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"
#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct JointCalibrationOptions {
  // robot, address; of the virtual robot also world, mcu, image, sensors, imu, supply_volts, seed.
  BackendOptions backend;
  std::string only;                // "stops", "floor", "gauge"; empty: stops, then floor
  std::vector<std::string> gauge;  // NAME=DEGREES or all=DEGREES
  double gauge_error_deg = 0.5;    // one standard deviation
  std::string memory;    // file of the virtual board's flash, read if it is there, and written
  std::string out;       // folder for the report; none if empty
  bool yes = false;      // do not ask at a port
  bool dry_run = false;  // print what would be moved, open nothing
  bool store = true;     // false: leave the board as it was
  bool json = false;     // result on standard output, no progress
};

// Prints the report and stores the calibration, unless a joint that was to be calibrated has no good reading:
// then the outcome is a failure and the board as it was; so it is after an interrupt or any other error, with
// what was read until then in `out`.
Result<Outcome> calibrate_joints(const JointCalibrationOptions& options);

}  // namespace kaz::tools
