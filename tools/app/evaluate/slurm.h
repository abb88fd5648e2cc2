// An evaluation as a Slurm job array: written, submitted, waited for, merged.
// SPDX-License-Identifier: Apache-2.0
//
// Each task is `kaz evaluate` with a --shard of its own. It works in a folder that no other has and renames
// that at the end, so a task that runs twice (requeued when its node was given up, though its steps lived on)
// leaves one part. DIR/parts/N is the part of task N; DIR/slurm has the script, what tasks printed, and the
// job's number.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/evaluate/campaign.h"

namespace kaz::tools {

struct SlurmOptions {
  int tasks = 0;                         // of the array; 0: no Slurm
  std::vector<std::string> submit = {};  // options for sbatch
  // How this program was called, without its name: what tasks repeat, as task_words() has it.
  std::vector<std::string> words = {};
};

// Waits until all parts are there and merges them into options.out, whose result is returned as
// run_campaign() does. Called again, it waits for the tasks that are under way and submits those that have
// ended without a part; so it does by itself, as long as some parts come. Errors (environment): no sbatch,
// or it refuses; tasks that ended without a part, whose output is named. An interrupt ends the waiting alone:
// the tasks go on.
Result<bool> run_on_slurm(const CampaignOptions& options, const SlurmOptions& slurm);

// Of the words of a command line, those that a task repeats.
std::vector<std::string> task_words(const std::vector<std::string>& words);
// The array's script. `program`: the path of kaz.
std::string slurm_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks, int jobs);
// "1-3,7" of 1, 2, 3, 7.
std::string array_text(const std::vector<int>& tasks);

}  // namespace kaz::tools
