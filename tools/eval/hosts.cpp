// Begins GNU parallel with the tasks that are missing, and counts their parts.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/hosts.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>

#include "host/link/wall_clock.h"
#include "shared/base/files.hpp"
#include "shared/base/shell_word.hpp"
#include "tools/base/child.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/eval/tasks.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kLook{500};
constexpr int kTasks = 100;
constexpr int kNoProgram = 127;  // Child's, as a shell's

// The first asks parallel to begin no more tasks, the second to end those that run.
void end(Child& parallel) {
  for (const auto patience : {std::chrono::seconds(0), std::chrono::seconds(20)}) {
    parallel.signal(SIGTERM);
    parallel.wait(patience);
  }
}

}  // namespace

std::string hosts_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks) {
  return task_script({"", "$1", "$(hostname).$$"}, program, words, folder, tasks);
}

std::string hosts_commands(const std::string& script, const std::vector<int>& tasks) {
  std::string commands;
  for (const int task : tasks)
    commands += "sh " + shell_word(script) + " " + std::to_string(task) + '\0';
  return commands;
}

Result<bool> run_on_hosts(const CampaignOptions& options, const HostsOptions& hosts) {
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  std::error_code wrong;
  const std::string file = fs::absolute(hosts.hosts, wrong).lexically_normal().string();
  if (const auto text = read_whole_file(hosts.hosts, 1 << 20, "give a file that lists the hosts");
      !text)
    return tl::unexpected(text.error());
  const std::string out = fs::absolute(options.out, wrong).lexically_normal().string();
  const std::string program = fs::read_symlink("/proc/self/exe", wrong).string();
  const int tasks = hosts.tasks > 0
                        ? hosts.tasks
                        : static_cast<int>(std::min<std::uint64_t>(kTasks, options.episodes));
  const std::string own = out + "/parallel";
  const auto folder = KAZ_TRY(open_campaign(out));
  KAZ_TRY(write_task_script(out, "parallel", "task.sh",
                            hosts_script(program, task_words(hosts.words), out, tasks)));

  std::vector<int> missing = without_part(out, tasks);
  host::WallClock waiting(&interrupt);
  Progress progress("kaz evaluate", options.json);
  if (!missing.empty()) {
    remove_unfinished(out, tasks);
    KAZ_TRY(write_whole_file(own + "/tasks", hosts_commands(own + "/task.sh", missing)));
    // Of each host's processors a task takes --jobs.
    const std::string share = std::to_string(std::max(1, 100 / options.jobs)) + "%";
    auto parallel =
        KAZ_TRY(Child::begin("parallel",
                             {"--will-cite", "--sshloginfile", file, "--jobs", share, "--retries",
                              "3", "--joblog", own + "/log", "--null", "::::", own + "/tasks"},
                             own + "/out"));
    while (!parallel.ended()) {
      if (!waiting.sleep_until(waiting.now() + kLook)) {
        progress.done();
        end(parallel);
        return fail(Fault::interrupted,
                    "interrupted; the same command continues with the remaining tasks");
      }
      const auto done = static_cast<std::size_t>(tasks) - without_part(out, tasks).size();
      progress.update(static_cast<double>(done) / tasks,
                      std::to_string(done) + " of " + std::to_string(tasks) + " tasks");
    }
    missing = without_part(out, tasks);
    if (!missing.empty() && *parallel.ended() == kNoProgram)
      return fail(Fault::environment,
                  "--parallel-hosts needs the command parallel (Debian: apt-get install parallel)");
  }
  progress.done();
  if (!missing.empty())
    return fail(Fault::environment, task_list(missing) + " ended without a result: see " + own +
                                        "/out; the same command runs these tasks again");
  return merge_tasks(folder, tasks, options.json);
}

}  // namespace kaz::tools
