// `kaz bus record`: records a motion that the user makes by hand, for `kaz run play`.
// SPDX-License-Identifier: Apache-2.0
// `kaz bus status`: reads each servo once.
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/base/exit_status.h"
#include "tools/run/backend_options.h"

namespace kaz::tools {

struct MotionRecordOptions {
  BackendOptions backend;  // only robot and robot_file are used
  double seconds = 20;
  std::string out;       // file of poses to write
  bool release = false;  // switches the servos' torque off first
  bool json = false;
};

// Reads the joint angles while the user moves the joints, and writes the file of poses. Drives no servo. The
// outcome is a failure if no joint moved, or if a joint was outside of its limits.
Result<ExitStatus> record_motion(const MotionRecordOptions& options);

struct BusStatusOptions {
  BackendOptions backend;
  bool json = false;
};

// Prints angle, torque, load, current, voltage, temperature and errors of each servo. Writes to no servo. The
// outcome is a failure if a servo does not reply or reports an error.
Result<ExitStatus> print_bus_status(const BusStatusOptions& options);

}  // namespace kaz::tools
