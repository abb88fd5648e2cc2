// Opens the results folder of a run.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_files.h"

#include "tools/run/run_report.h"

namespace kaz::tools {

Result<RunFiles> RunFiles::open(const RunPlan& plan, RunObserver& observer) {
  RunFiles files(plan);
  if (!plan.options().out.empty()) {
    auto opened = OutputFolder::open(plan.options().out, run_output());
    if (!opened && opened.error().fault == Fault::environment) observer.lost(opened.error());
    files.folder_ = KAZ_TRY(std::move(opened));
  }
  files.discard_recording();
  return files;
}

RunFiles::RunFiles(const RunPlan& plan)
    : recording_(plan.records_in_folder() ? plan.backend().recording : "") {}

Result<void> RunFiles::begin() {
  if (folder_) KAZ_TRY(folder_->clear());
  remover_->keep();
  return {};
}

void RunFiles::discard_recording() {
  remover_ = std::make_unique<FileRemover>(recording_);
}

}  // namespace kaz::tools
