// `kaz bus record`: a motion by hand, for `kaz run play`; and `kaz bus status`: each servo once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/app/base/outcome.h"
#include "tools/app/session/backend_options.h"

namespace kaz::tools {

struct MotionRecordOptions {
  BackendOptions backend;  // robot and robot_file
  double seconds = 20;
  std::string out;       // file of poses
  bool release = false;  // a torque that is on is switched off at the beginning
  bool json = false;
};

// Reads the joints while somebody moves them, and writes the file of poses. Nothing is driven. False: nothing
// moved, or a joint was outside of its limits.
Result<Outcome> record_motion(const MotionRecordOptions& options);

struct BusStatusOptions {
  BackendOptions backend;
  bool json = false;
};

// Prints angle, torque, load, current, voltage, heat and errors of each servo. Writes nothing. False: one
// does not answer, or reports an error.
Result<Outcome> print_bus_status(const BusStatusOptions& options);

}  // namespace kaz::tools
