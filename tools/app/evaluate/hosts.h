// An evaluation on several machines without a cluster's scheduler, by GNU parallel and ssh.
// SPDX-License-Identifier: Apache-2.0
//
// Tasks are those of tasks.h; DIR/parallel has their script, parallel's log of them, and what they printed.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/evaluate/campaign.h"

namespace kaz::tools {

struct HostsOptions {
  std::string hosts;                    // a file as parallel's --sshloginfile; empty: none
  int tasks = 0;                        // 0: 100, or an episode each
  std::vector<std::string> words = {};  // as SlurmOptions has them
};

// Runs the tasks that have left no part yet, waits, and merges all into options.out, whose result is returned
// as run_campaign() does. A task that fails is run again, on another host if there is one, up to three times.
// Errors (environment): no parallel; tasks that ended without a part, with where it says why. An interrupt
// ends those that are running; parts that are there stay.
Result<bool> run_on_hosts(const CampaignOptions& options, const HostsOptions& hosts);

// The script of a task; its number is the first argument.
std::string hosts_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks);

// Commands that run the script for these tasks, each followed by a NUL. As input of GNU parallel a command is
// passed on as it is. In parallel's arguments, `{}` in the script's path would be replaced.
std::string hosts_commands(const std::string& script, const std::vector<int>& tasks);

}  // namespace kaz::tools
