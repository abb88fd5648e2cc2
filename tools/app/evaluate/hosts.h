// Runs an evaluation on several machines without a cluster scheduler, with GNU parallel and ssh.
// SPDX-License-Identifier: Apache-2.0
//
// The tasks are those of tasks.h. DIR/parallel contains their script, parallel's log of them, and their
// output.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/evaluate/campaign.h"

namespace kaz::tools {

struct HostsOptions {
  std::string hosts;                    // file for parallel's --sshloginfile; empty: none
  int tasks = 0;                        // 0: 100, or one per episode if there are fewer
  std::vector<std::string> words = {};  // as SlurmOptions::words
};

// Runs the tasks that have no part yet, waits, and merges all parts into options.out. Returns the merged
// result as run_campaign(). A failed task runs up to three times, on another host if there is one. Fails
// (environment) if parallel is missing, or if tasks ended without a part; the message names their output. An
// interrupt ends running tasks; existing parts stay.
Result<bool> run_on_hosts(const CampaignOptions& options, const HostsOptions& hosts);

// Returns the script of a task. Its first argument is the task's number.
std::string hosts_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks);

// Returns commands that run the script for these tasks, each followed by a NUL. They are input of GNU
// parallel, which passes them on unchanged. In parallel's arguments, `{}` in the script's path would be
// replaced.
std::string hosts_commands(const std::string& script, const std::vector<int>& tasks);

}  // namespace kaz::tools
