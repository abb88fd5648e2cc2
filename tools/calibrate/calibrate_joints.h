// `kaz calibrate joints`: calibrates the potentiometers of the joints.
// SPDX-License-Identifier: Apache-2.0
// Methods: mechanical stops, gravity and symmetry, or a gauge.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/base/exit_status.h"
#include "tools/run/backend_options.h"

namespace kaz::tools {

struct JointCalibrationOptions {
  // The command uses the members robot and address. For the virtual robot the command also uses world, mcu,
  // image, sensors, imu, supply_volts and seed.
  BackendOptions backend;
  std::string only;  // method: "stops", "floor" or "gauge"; empty: stops, then floor
  // Joints and their angles at the gauge: NAME=DEGREES or all=DEGREES.
  std::vector<std::string> gauge;
  double gauge_error_deg = 0.5;  // standard deviation of an angle at the gauge
  // File with the virtual board's flash; read first if it exists, and written at the end.
  std::string memory;
  std::string out;       // folder for the report; empty: no report is written
  bool yes = false;      // does not ask for confirmation at a port
  bool dry_run = false;  // prints the motions without opening a port
  bool store = true;     // false: does not write the calibration to the board
  bool json = false;     // prints the result to standard output, and no progress
};

// Prints the report and stores the calibration. If a joint to calibrate has no good reading, the outcome is a
// failure and the board stays unchanged. After an interrupt or another error the board also stays unchanged;
// `out` then contains the readings so far.
Result<ExitStatus> calibrate_joints(const JointCalibrationOptions& options);

}  // namespace kaz::tools
