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
#include "shared/base/result.hpp"
#include "tools/app/session/backend.h"
#include "tools/app/session/snapshots.h"
#include "tools/app/vision/modules.h"

namespace kaz::tools {

// Observes the simulated world while a behavior runs, for scoring. Behaviors have no access to it.
class Onlooker {
 public:
  virtual ~Onlooker() = default;
  // Called on the behavior's thread when it has waited or reads the time.
  virtual void look(sim::Simulation& simulation) = 0;
};

struct SessionOptions {
  BackendOptions backend;
  std::string behavior = "track-ball";          // name, or path of a plug-in
  std::map<std::string, std::string> settings;  // options of the behavior
  std::string out;                              // folder for results; none if empty
  bool quiet = false;                           // prints no result
  bool json = false;                 // prints result.json to standard output, and no progress
  std::string label = "kaz run";     // prefix of messages
  VisionOptions vision;              // the module `color` is always added
  VisionWatcher* watcher = nullptr;  // may be null; else must outlive the session
  // Called for each pair that the host receives.
  std::function<void(const vision::StereoPair&)> on_pair;
  // Returns the requests since the last call, for a behavior that takes requests. They are recorded in
  // /behavior.
  std::function<std::vector<std::string>(Time now)> requests;
  bool profile = false;          // measures a profile (run_profile.h)
  bool keep_interrupted = true;  // writes the results of an interrupted run
  // For a simulated robot; may be null, else must outlive the session.
  Onlooker* onlooker = nullptr;
  // Receives the behavior's reports; may be null, else must outlive the session.
  behavior::Sink* listener = nullptr;
  // For a simulated robot: the run ends at this time as by Ctrl-C. This is no error; run_session() returns
  // false.
  std::optional<Time> until;
  // Called with the outcome of the behavior, its duration (s of robot time), and that duration over wall
  // time.
  std::function<void(const Result<behavior::Outcome>&, double, double)> on_end;
  // Returns whether to write the results of a run that ended with a report; if not, the recording is removed,
  // too. If empty, results are always written. Drawing the pictures takes a sixth of the CPU time of a catch.
  std::function<bool()> worth_keeping;
  // Receives the pictures of the run's moments, which are drawn only for this. Not called for an interrupted
  // run.
  std::function<void(const std::vector<MomentPictures>&)> on_moments;
  // Called if the machine, not the robot, ended the session: files, disk, display or port. Before or after
  // on_end.
  std::function<void(const Error&)> on_loss;
  // Called if the behavior's code is faulty. False: it threw an exception. True: a plug-in crashed, ended the
  // process, or did not return after an interrupt (the error's fault). In this case another thread calls it,
  // after on_end and last before the process ends.
  std::function<void(const Error&, bool)> on_crash;
  // Replaces SessionBackend::open(). Objects that it refers to must outlive the session.
  std::function<Result<std::unique_ptr<SessionBackend>>(host::Interrupt&)> open_backend;
};

// Runs a behavior. Checks and locks the results folder before it opens a device (output_folder.h). Always
// switches the motors off at the end. Returns:
// - true: the behavior succeeded.
// - false: the behavior did not succeed, or returned Fault::failed, as when the board switches its motors
//   off. The report is complete; for an error its cause is `error`. Also false, without a report, if the run
//   ended at `until`.
// - Fault::interrupted: a signal ended the run. result.json and the recording cover the time until then, and
//   are marked as interrupted.
// - Fault::environment with a complete report: a run at a port did not succeed while this program or the
//   simulator was late (run_lateness.h). The outcome in the report is `environment`.
// - Other errors: the run broke off. Its recording is kept. If the machine was the cause, result.json has the
//   outcome `environment`. If the behavior threw an exception, it has the outcome `failed` and the cause
//   `crashed`.
// A plug-in may end the process instead (plugin_guard.h).
Result<bool> run_session(SessionOptions options);

}  // namespace kaz::tools
