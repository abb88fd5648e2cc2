// `kaz robot check`: what Kaz reads from a robot's description.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"

namespace kaz::tools {

struct CheckRobotOptions {
  std::string file;
  std::string picture;  // PNG; empty: none
  std::string urdf;     // the robot as a URDF; empty: none
  sim::ReadOptions reading;
  bool write = false;    // write missing files (starter_files.h)
  bool verbose = false;  // list each note with its line
  bool json = false;
};

// Reads the file, and prints joints, masses, notes, and the files that are missing for simulation and bus.
// Returns the errors of the file, all together.
Result<void> check_robot(const CheckRobotOptions& options);

}  // namespace kaz::tools
