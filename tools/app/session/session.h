// One behaviour from start to end on a backend, with everything that is kept of it.
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

// Sees the simulated world as it is while a behaviour runs: for scores. No behaviour sees it.
class Onlooker {
 public:
  virtual ~Onlooker() = default;
  virtual void look(sim::Simulation& simulation) = 0;
};

struct SessionOptions {
  BackendOptions backend;
  std::string behavior = "track-ball";          // name, or path of a plug-in, which is loaded
  std::map<std::string, std::string> settings;  // the behaviour's options
  std::string out;                              // folder for results; none if empty
  bool quiet = false;                           // prints no result
  bool json = false;                            // result.json on standard output, no progress
  std::string label = "kaz run";                // begins progress lines
  VisionOptions vision;                         // always with the module color
  VisionWatcher* watcher = nullptr;             // must outlive the session
  std::function<void(const vision::StereoPair&)> on_pair;  // each that the host has got
  // What is asked of a behaviour that takes requests, since the last call; recorded in /behavior.
  std::function<std::vector<std::string>(Time now)> requests;
  bool profile = false;                // measures where the time goes
  bool keep_interrupted = true;        // writes what there is of an interrupted run
  Onlooker* onlooker = nullptr;        // of a simulated robot; must outlive the session
  behavior::Sink* listener = nullptr;  // hears what the behaviour reports; must outlive the session
  // Of a simulated robot: the run ends there as by Ctrl-C, which is no error; its result is false.
  std::optional<Time> until;
  // How the behaviour ended, how long it took (s of the robot), and that over wall time.
  std::function<void(const Result<behavior::Outcome>&, double, double)> on_end;
  // Whether results are written of a run that has ended with a report; else its recording is removed, too.
  // Always, if this is empty. Pictures take a sixth of the CPU time of a catch.
  std::function<bool()> worth_keeping;
  // The pictures of the run's moments, drawn for this alone; not of an interrupted run.
  std::function<void(const std::vector<MomentPictures>&)> on_moments;
  // The machine, not the robot, ended the session: files, disk, display, port. Before on_end or after.
  std::function<void(const Error&)> on_loss;
  // The behaviour's program is in error. False: it threw. True: it is a plug-in that crashed, ended the
  // process, or does not return after an interrupt (the error's fault); this is called on another thread,
  // after on_end, as the last before the process ends.
  std::function<void(const Error&, bool)> on_crash;
  // In place of SessionBackend::open(); what it refers to must outlive the session.
  std::function<Result<std::unique_ptr<SessionBackend>>(host::Interrupt&)> open_backend;
};

// False where the behaviour did not succeed, or returned an error that is the robot's (Fault::failed), as
// when the board switches its motors off: the report is whole, of the cause `error`. Motors are off
// afterwards, whatever happened. The folder is checked and locked before anything is opened
// (output_folder.h). Of an interrupted run (Fault::interrupted) result.json and recording are of the part
// until then, and say so. A run at a port that did not succeed while this program or the simulator was late
// (run_lateness.h) is an error (Fault::environment), its report whole, with the outcome `environment`. Of a
// run that broke off there is the recording and, where the machine was the cause, a result.json with the
// outcome `environment`; where the behaviour's program was (an exception), with `failed` and the cause
// `crashed`. A plug-in may end the process instead (plugin_guard.h).
Result<bool> run_session(SessionOptions options);

}  // namespace kaz::tools
