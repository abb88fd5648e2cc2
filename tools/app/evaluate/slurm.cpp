// Writes the array's script, submits it by sbatch, watches it by squeue.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/evaluate/slurm.h"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "host/link/wall_clock.h"
#include "shared/base/files.hpp"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/base/output.h"
#include "tools/app/base/provenance.h"
#include "tools/app/evaluate/tasks.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kLook{2};
// Looks in which Slurm knows nothing of the job before it counts as ended: squeue shows a requeued task
// at once, but a controller that starts anew shows none for a moment.
constexpr int kLooks = 3;

struct Ran {
  int status = 0;
  std::string output;  // of both streams
};

// By the shell.
Ran run(const std::string& command) {
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  Ran ran;
  if (pipe == nullptr) return {127, "no process could be started"};
  std::array<char, 4096> some{};
  while (const std::size_t count = std::fread(some.data(), 1, some.size(), pipe))
    ran.output.append(some.data(), count);
  const int status = pclose(pipe);
  ran.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  while (ran.output.ends_with('\n')) ran.output.pop_back();
  return ran;
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

// The number of the job that an earlier call has submitted; empty: none.
std::string job_of(const std::string& out) {
  const auto text = read_whole_file(out + "/slurm/job", 100);
  if (!text || text->find_first_not_of("0123456789\n") != std::string::npos) return "";
  return first_line(*text);
}

// Whether the job has tasks that wait or run. Errors: Slurm does not answer.
Result<bool> is_under_way(const std::string& job) {
  if (job.empty()) return false;
  const Ran ran = run("squeue --noheader --jobs " + job + " --format %T");
  if (ran.status == 0) return !ran.output.empty();
  // So it says of a job that it has forgotten.
  if (ran.output.find("Invalid job id") != std::string::npos) return false;
  return fail(Fault::environment, "squeue: " + first_line(ran.output));
}

Result<std::string> submit(const std::string& out, const SlurmOptions& slurm,
                           const std::vector<int>& tasks) {
  std::string command = "sbatch --parsable --requeue --array=" + array_text(tasks) +
                        " --output=" + shell_word(out + "/slurm/%A_%a.out") + " --job-name=kaz";
  for (const std::string& option : slurm.submit) command += " " + shell_word(option);
  const Ran ran = run(command + " " + shell_word(out + "/slurm/job.sh"));
  if (ran.status == 127)
    return fail(Fault::environment,
                "--slurm needs the command sbatch, on a machine that submits to a cluster "
                "(Debian: slurm-client)");
  std::string job = first_line(ran.output);
  job = job.substr(0, job.find(';'));  // behind it may stand the cluster's name
  if (ran.status != 0 || job.empty() || job.find_first_not_of("0123456789") != std::string::npos)
    return fail(Fault::environment, "sbatch refused the job: " + first_line(ran.output) +
                                        " (options for it: --sbatch; its script: " + out +
                                        "/slurm/job.sh)");
  KAZ_TRY(write_whole_file(out + "/slurm/job", job + "\n"));
  return job;
}

}  // namespace

std::string slurm_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks, int jobs) {
  const TaskScript by{"#SBATCH --cpus-per-task=" + std::to_string(jobs) + "\n",
                      "$SLURM_ARRAY_TASK_ID", "$SLURM_JOB_ID.${SLURM_RESTART_COUNT:-0}.$$"};
  return task_script(by, program, words, folder, tasks);
}

Result<bool> run_on_slurm(const CampaignOptions& options, const SlurmOptions& slurm) {
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  std::error_code wrong;
  const std::string out = fs::absolute(options.out, wrong).lexically_normal().string();
  const std::string program = fs::read_symlink("/proc/self/exe", wrong).string();
  const std::string script =
      slurm_script(program, task_words(slurm.words), out, slurm.tasks, options.jobs);
  KAZ_TRY(write_task_script(out, "slurm", "job.sh", script));

  std::string job = job_of(out);
  std::vector<int> missing = without_part(out, slurm.tasks);
  if (!missing.empty() && !KAZ_TRY(is_under_way(job))) {
    remove_unfinished(out, slurm.tasks);
    job = KAZ_TRY(submit(out, slurm, missing));
    if (!options.json)
      std::printf("job %s: %s of %d\n", job.c_str(), task_list(missing).c_str(), slurm.tasks);
  } else if (!missing.empty() && !options.json) {
    std::printf("job %s is under way\n", job.c_str());
  }
  std::fflush(stdout);

  host::WallClock waiting(&interrupt);
  Progress progress("kaz evaluate", options.json);
  int gone = 0;
  std::size_t at_submission = missing.size();
  while (!missing.empty()) {
    const auto done = static_cast<std::size_t>(slurm.tasks) - missing.size();
    progress.update(static_cast<double>(done) / slurm.tasks,
                    std::to_string(done) + " of " + std::to_string(slurm.tasks) + " tasks");
    if (!waiting.sleep_until(waiting.now() + kLook)) {
      progress.done();
      return fail(Fault::interrupted, "interrupted; job " + job +
                                          " goes on: the same command waits for it, `scancel " +
                                          job + "` ends it");
    }
    const auto under_way = is_under_way(job);
    missing = without_part(out, slurm.tasks);
    if (missing.empty()) break;
    gone = under_way && !*under_way ? gone + 1 : 0;
    if (gone < kLooks) continue;
    // Tasks that a failing node took along: again, as long as some come through.
    if (missing.size() < at_submission) {
      at_submission = missing.size();
      gone = 0;
      remove_unfinished(out, slurm.tasks);
      job = KAZ_TRY(submit(out, slurm, missing));
      progress.announce(0, "job " + job + ": " + task_list(missing) + " once more");
      continue;
    }
    progress.done();
    return fail(Fault::environment, task_list(missing) + " of job " + job +
                                        " ended without a result: see " + out + "/slurm/" + job +
                                        "_" + std::to_string(missing.front()) +
                                        ".out; the same command submits them again");
  }
  progress.done();
  return merge_tasks(out, slurm.tasks, options.json);
}

}  // namespace kaz::tools
