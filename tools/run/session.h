// Runs one behavior on a backend from start to end, and writes its results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/behavior/behavior.h"
#include "host/behavior/sink.h"
#include "shared/base/result.hpp"
#include "tools/run/backend.h"
#include "tools/vision/modules.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Observes the simulated world while a behavior runs, for scoring. Behaviors have no access to the observer.
class Onlooker {
 public:
  virtual ~Onlooker() = default;
  // Called on the behavior's thread each time the behavior has waited or reads the time.
  virtual void look(sim::Simulation& simulation) = 0;
};

struct SessionOptions {
  BackendOptions backend;
  std::string behavior = "track-ball";          // name, or path of a plug-in
  std::map<std::string, std::string> settings;  // options of the behavior
  std::string out;                              // folder for results; empty: no results are written
  bool quiet = false;                           // does not print a result
  bool json = false;                 // prints result.json to standard output, and no progress
  std::string label = "kaz run";     // prefix of messages
  VisionOptions vision;              // options of vision; the module `color` is always added
  VisionWatcher* watcher = nullptr;  // if not null, the watcher must outlive the session
  // Called for each stereo pair that the host receives.
  std::function<void(const vision::StereoPair&)> on_pair;
  // For a behavior that accepts requests: returns the requests since the last call. The requests are recorded
  // in /behavior.
  std::function<std::vector<std::string>(Time now)> requests;
  bool profile = false;          // measures a profile (run_profile.h)
  bool keep_interrupted = true;  // writes the results of an interrupted run
  // Observer of the simulated world. If not null, the observer must outlive the session.
  Onlooker* onlooker = nullptr;
  // Receives the behavior's reports. If not null, the listener must outlive the session.
  behavior::Sink* listener = nullptr;
  // For a simulated robot: the run ends at this time in the same way as after Ctrl-C. This end is no error:
  // run_session() returns false.
  std::optional<Time> until;
  // Called at the end of the behavior. Arguments: outcome, duration in s of robot time, ratio of this
  // duration to wall time.
  std::function<void(const Result<behavior::Outcome>&, double, double)> on_end;
  // Returns whether to write the results of a run that ended with a report. If worth_keeping() returns false,
  // the recording is also removed. If the function is empty, results are always written. Skipping the results
  // saves time: drawing the pictures takes a sixth of the CPU time of catch-ball.
  std::function<bool()> worth_keeping;
  // Called if the machine, not the robot, ended the session: files, disk, display or port. May be called
  // before or after on_end.
  std::function<void(const Error&)> on_loss;
  // Called before on_end if the behavior threw an exception.
  std::function<void()> on_throw;
  // Called instead of SessionBackend::open(). Objects to which this function refers must outlive the session.
  std::function<Result<std::unique_ptr<SessionBackend>>(host::Interrupt&)> open_backend;
};

// Runs a behavior. Checks and locks the results folder (output_file.h) before opening a device. Always
// switches the motors off at the end. Returns:
// - true: the behavior succeeded.
// - false: the behavior did not succeed, or returned Fault::failed, for example because the board switched
//   its motors off. The report is complete; after Fault::failed, the cause in the report is `error`. Also
//   false, without a report, if the run ended at `until`.
// - Fault::interrupted: a signal ended the run. result.json and the recording cover the time until the
//   signal, and are marked as interrupted.
// - Fault::environment with a complete report: a run at a port did not succeed while this program or the
//   simulator was late (run_lateness.h). The outcome in the report is `environment`.
// - Other errors: the run broke off. The recording of the run is kept. If the machine was the cause,
//   result.json has the outcome `environment`. If the behavior threw an exception, result.json has the
//   outcome `failed` and the cause `crashed`.
// If a plug-in crashes, the process ends at once, and the board's link watchdog stops the robot.
Result<bool> run_session(SessionOptions options);

}  // namespace kaz::tools
