// The connected robot of a run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/link/interrupt.h"
#include "host/robot/robot.h"
#include "tools/base/output_file.h"
#include "tools/kept/kept_run.h"
#include "tools/run/backend.h"
#include "tools/run/run_observer.h"
#include "tools/run/run_plan.h"

namespace kaz::tools {

// Clock of the behavior. Calls RunObserver::look() whenever the behavior has waited or reads the time. A
// behavior that keeps the line busy does nothing else. Ends the run at RunOptions::until.
class RunClock final : public host::Clock {
 public:
  RunClock(SessionBackend& backend, RunObserver& observer, std::optional<Time> until,
           host::Interrupt& interrupt);
  Time now() const override;
  Result<void> sleep_until(Time time) override;
  // Returns whether the time RunOptions::until has come.
  bool ended() const { return until_ && clock_.now() >= *until_; }

 private:
  host::Clock& clock_;
  sim::Simulation* simulation_;
  RunObserver& observer_;
  std::optional<Time> until_;
  host::Interrupt& interrupt_;
  mutable Time looked_{-1};
};

// Backend, boards and connection of a run. The destructor closes the connection, restores the boards, and
// closes the backend.
struct RunRobot {
  std::unique_ptr<SessionBackend> backend;
  std::vector<std::unique_ptr<KeptRun>> kept;  // one for each board at a port
  std::unique_ptr<RunClock> clock;
  host::Robot robot;

  // Opens the backend and connects the robot. `folder`: folder for the dump of received frames; null: a
  // temporary folder. Prints lost and resumed connections on standard error. All arguments must outlive the
  // returned object.
  static Result<RunRobot> open(const RunPlan& plan, RunObserver& observer,
                               const OutputFolder* folder, host::Interrupt& interrupt);
  bool at_port() const { return backend->port() != nullptr; }
  // Restores all boards. Returns the first error.
  Result<void> end_kept();
};

}  // namespace kaz::tools
