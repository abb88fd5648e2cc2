// The end of a run: the values that the run leaves, and the files written from them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/behavior/behavior.h"
#include "shared/faults/faults.h"
#include "shared/protocol/messages.h"
#include "tools/run/run_lateness.h"
#include "tools/run/run_profile.h"
#include "tools/run/run_stack.h"

namespace kaz::tools {

struct RunEnd {
  Result<behavior::Outcome> outcome = {};
  bool threw = false;  // the behavior threw an exception
  double run_s = 0,
         wall_s = 0;  // duration in robot time and in wall time; 0: the behavior did not begin
  std::vector<faults::Fault> not_begun = {};  // SessionBackend::faults_not_begun()
  std::optional<RunProfile> profile = {};
  std::optional<RunLateness> lateness = {};  // set only for a run at a port
  bool machine_failed = false;               // BehaviorReport::machine_failed
  Result<kz_statistics_reply> health = {};   // the board's statistics
  Result<void> left = {};                    // error if a board could not be restored
  Result<std::string> sha256 = {};           // hash of the complete recording; empty without one

  bool interrupted() const { return !outcome && outcome.error().fault == Fault::interrupted; }
};

// Returns the error of a run without a complete report. Writes result.json for a run that broke off, and
// completes its recording.
Result<void> check_end(RunStack& stack, RunEnd& end);
// Completes the recording, writes all results, and prints the report. Returns the result of run().
Result<bool> report(RunStack& stack, RunEnd& end);
// Call lost() if the machine ended the run: writes result.json with the outcome `environment`, and calls
// RunObserver::lost(). Returns `error`.
Error lost(RunStack& stack, const RunEnd& end, Error error);

}  // namespace kaz::tools
