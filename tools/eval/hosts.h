// Runs an evaluation on several machines without a cluster scheduler, with GNU parallel and ssh.
// SPDX-License-Identifier: Apache-2.0
//
// tasks.h defines the tasks. The folder DIR/parallel contains the tasks' script, GNU parallel's log, and the
// output of the tasks.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/eval/campaign.h"

namespace kaz::tools {

struct HostsOptions {
  // File for the option --sshloginfile of GNU parallel; empty: no file.
  std::string hosts;
  // Number of tasks; 0: 100 tasks, or one per episode if there are fewer than 100 episodes.
  int tasks = 0;
  std::vector<std::string> words = {};  // same as SlurmOptions::words
};

// Runs the tasks that have no part yet, waits, and merges all parts into options.out. Returns whether an
// episode succeeded, like run_campaign(). A failed task runs up to three times, on another host if there are
// several hosts. Fails (environment) if GNU parallel is missing, or if tasks ended without a part; the
// message contains the path of the output folder. An interrupt ends running tasks; existing parts stay.
Result<bool> run_on_hosts(const CampaignOptions& options, const HostsOptions& hosts);

// Returns the script that runs one task. The first argument of the script is the task's number.
std::string hosts_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks);

// Returns one command per task. Each command runs the script for its task. A NUL character follows each
// command. GNU parallel reads these commands from its input and passes them on unchanged. If the commands
// were arguments of GNU parallel, `{}` in the script's path would be replaced.
std::string hosts_commands(const std::string& script, const std::vector<int>& tasks);

}  // namespace kaz::tools
