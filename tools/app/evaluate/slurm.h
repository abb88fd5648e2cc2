// An evaluation as a Slurm job array: written, submitted, waited for, merged.
// SPDX-License-Identifier: Apache-2.0
//
// Tasks are those of tasks.h; DIR/slurm has their script, what they printed, and the job's number.
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

// The array's script. `program`: the path of kaz.
std::string slurm_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks, int jobs);

// A path without backslash as part of Slurm's name of an output file, in which `%` begins a symbol.
std::string slurm_pattern(const std::string& path);

}  // namespace kaz::tools
