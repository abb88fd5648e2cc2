// `kaz bus record`: records a motion by hand for `kaz run play`. `kaz bus status`: reads each servo once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"
#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct MotionRecordOptions {
  BackendOptions backend;  // uses robot and robot_file
  double seconds = 20;
  std::string out;       // file of poses
  bool release = false;  // switches the torque off first, if it is on
  bool json = false;
};

// Reads the joints while the user moves them, and writes the file of poses. Drives no servo. The outcome is a
// failure if nothing moved, or if a joint was outside of its limits.
Result<Outcome> record_motion(const MotionRecordOptions& options);

struct BusStatusOptions {
  BackendOptions backend;
  bool json = false;
};

// Prints angle, torque, load, current, voltage, temperature and errors of each servo. Writes to no servo. The
// outcome is a failure if a servo does not reply or reports an error.
Result<Outcome> print_bus_status(const BusStatusOptions& options);

}  // namespace kaz::tools
