// Options of a run, and the plan that is made from them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/behavior/behavior.h"
#include "shared/base/result.hpp"
#include "tools/run/backend.h"
#include "tools/run/target.h"
#include "tools/vision/modules.h"

namespace kaz::tools {

struct RunOptions {
  BackendOptions backend;
  std::string behavior = "track-ball";          // name, or path of a plug-in
  std::map<std::string, std::string> settings;  // options of the behavior
  std::string out;                              // folder for results; empty: no results are written
  bool quiet = false;                           // does not print a result
  bool json = false;              // prints result.json to standard output, and no progress
  std::string label = "kaz run";  // prefix of messages
  VisionOptions vision;           // options of vision; the module `color` is always added
  bool profile = false;           // measures a profile (run_profile.h)
  bool keep_interrupted = true;   // writes the results of an interrupted run
  // For a simulated robot: the run ends at this time in the same way as after Ctrl-C. This end is no error:
  // run() returns false.
  std::optional<Time> until;
  // For a behavior that accepts requests: returns the requests since the last call. The requests are recorded
  // in /behavior.
  std::function<std::vector<std::string>(Time now)> requests;
  // Called instead of SessionBackend::open(). Objects to which this function refers must outlive the run.
  std::function<Result<std::unique_ptr<SessionBackend>>(host::Interrupt&)> open_backend;
};

// Checked options of a run, with everything that follows from them. A plan does not change.
class RunPlan {
 public:
  // Checks all that can be checked without opening a device. Loads the plug-in, if the behavior is one. Fails
  // (usage) for invalid options.
  static Result<RunPlan> make(RunOptions options);

  // Options, completed: the robot's joints, the path of the recording, its header, and the vision modules
  // that the behavior needs.
  const RunOptions& options() const { return options_; }
  const BackendOptions& backend() const { return options_.backend; }
  const behavior::Behavior& behavior() const { return behavior_; }
  const behavior::OptionValues& values() const { return values_; }
  const Target& target() const { return target_; }
  // Returns true if the robot's servos are on a bus, without a board.
  bool on_servo_bus() const { return std::holds_alternative<BusTarget>(target_); }
  // Returns true if the recording is written in the results folder.
  bool records_in_folder() const { return records_in_folder_; }
  // Returns the maximum duration of the behavior in s, or 10 for a behavior without such an option.
  double expected_s() const;

 private:
  RunOptions options_;
  behavior::Behavior behavior_;
  behavior::OptionValues values_;
  Target target_;
  bool records_in_folder_ = false;
};

}  // namespace kaz::tools
