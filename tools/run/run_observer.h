// Observer of a run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/behavior.h"
#include "host/behavior/sink.h"
#include "shared/base/result.hpp"
#include "vision/image/frame.h"

namespace kaz::sim {
class Simulation;
}
namespace kaz::vision {
class Pipeline;
}

namespace kaz::tools {

// Receives what happens in a run, including the behavior's reports (Sink). All calls come from the thread
// that called run(). The observer must outlive the run. The default implementations do nothing.
class RunObserver : public behavior::Sink {
 public:
  // Called after the vision modules were added to the pipeline, before the first picture.
  virtual void begin_vision(vision::Pipeline&) {}
  // Called after the last picture, also if the run failed.
  virtual void end_vision(const vision::Pipeline&) {}
  // Returns true if this observer needs no further pictures. Only a replay of recorded pictures ends early.
  virtual bool has_all_pictures() const { return false; }
  // Called for each stereo pair that the host receives.
  virtual void pair(const vision::StereoPair&) {}
  // Called for a simulated robot, each time the behavior has waited or reads the time. Behaviors have no
  // access to the simulation.
  virtual void look(sim::Simulation&) {}
  // Called before ended() if the behavior threw an exception.
  virtual void threw() {}
  // Called at the end of the behavior. `run_s`: duration in s of robot time. `rtf`: ratio of this duration to
  // wall time.
  virtual void ended(const Result<behavior::Outcome>&, double /*run_s*/, double /*rtf*/) {}
  // Called if the machine, not the robot, ended the run: files, disk, display or port. May be called before
  // or after ended().
  virtual void lost(const Error&) {}
  // Returns whether to write the results of a run that ended with a report. If false, the recording is also
  // removed. This saves time: drawing the pictures takes a sixth of the CPU time of catch-ball.
  virtual bool is_worth_keeping() { return true; }
};

}  // namespace kaz::tools
