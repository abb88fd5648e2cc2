// The results folder of a run, and the recording that is written there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "tools/base/output.h"
#include "tools/run/run_observer.h"
#include "tools/run/run_plan.h"

namespace kaz::tools {

class RunFiles {
 public:
  // Checks and locks the plan's results folder, if there is one. Existing results do not change. Fails like
  // OutputFolder::open(). Reports environment errors to `observer`.
  static Result<RunFiles> open(const RunPlan& plan, RunObserver& observer);

  // Returns null for a run without a results folder.
  const OutputFolder* folder() const { return folder_ ? &*folder_ : nullptr; }
  // Removes the results of an earlier run. Until begin() returns without an error, the destructor removes the
  // recording.
  Result<void> begin();
  // Makes the destructor remove the recording.
  void discard_recording();

 private:
  explicit RunFiles(const RunPlan& plan);

  std::string recording_;  // empty: the recording is not written in the folder
  std::optional<OutputFolder> folder_;
  std::unique_ptr<FileRemover> remover_;
};

}  // namespace kaz::tools
