// Runs an evaluation as a Slurm job array: writes and submits it, waits, and merges the parts.
// SPDX-License-Identifier: Apache-2.0
//
// The tasks are those of tasks.h. DIR/slurm contains their script, their output, and the number of the job.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/evaluate/campaign.h"

namespace kaz::tools {

struct SlurmOptions {
  int tasks = 0;                         // size of the array; 0: no Slurm
  std::vector<std::string> submit = {};  // options for sbatch
  // Command line of this program without its name; tasks repeat it (task_words()).
  std::vector<std::string> words = {};
};

// Waits until all parts exist and merges them into options.out. Returns the merged result as run_campaign().
// A later call waits for running tasks, and submits those that ended without a part. The same happens within
// a call while further parts arrive. Fails (environment) if sbatch is missing or rejects the job, or if tasks
// ended without a part; the message names their output. An interrupt ends only the wait; the tasks continue.
Result<bool> run_on_slurm(const CampaignOptions& options, const SlurmOptions& slurm);

// Returns the script of the array. `program`: path of kaz.
std::string slurm_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks, int jobs);

// Returns a path for Slurm's output-file option, in which `%` begins a symbol. `path` must not contain a
// backslash.
std::string slurm_pattern(const std::string& path);

}  // namespace kaz::tools
