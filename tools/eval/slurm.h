// Runs an evaluation as a Slurm job array: writes and submits the job array, waits, and merges the parts.
// SPDX-License-Identifier: Apache-2.0
//
// tasks.h defines the tasks. The folder DIR/slurm contains the tasks' script, the output of the tasks, and
// the number of the job.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/eval/campaign.h"

namespace kaz::tools {

struct SlurmOptions {
  int tasks = 0;                         // size of the job array; 0: Slurm is not used
  std::vector<std::string> submit = {};  // options for sbatch
  // Command line of this program without the program's name. The tasks repeat this command line
  // (task_words()).
  std::vector<std::string> words = {};
};

// Submits the tasks, waits until all parts exist, and merges the parts into options.out. Returns whether an
// episode succeeded, like run_campaign(). If tasks end without a part, submits these tasks again, as long as
// each submission yields at least one new part. A later call waits for tasks that are still running, and
// submits only tasks that ended without a part. Fails (environment) if sbatch is missing or rejects the job.
// Also fails (environment) if a submission yields no new part; the message contains the path of one failed
// task's output. An interrupt ends only the wait; the tasks continue.
Result<bool> run_on_slurm(const CampaignOptions& options, const SlurmOptions& slurm);

// Returns the script of the job array. `program`: path of the executable kaz.
std::string slurm_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks, int jobs);

// Returns a path for Slurm's output-file option, in which `%` begins a symbol. `path` must not contain a
// backslash.
std::string slurm_pattern(const std::string& path);

}  // namespace kaz::tools
