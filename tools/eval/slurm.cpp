// Writes the array's script, submits it by sbatch, watches it by squeue.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/slurm.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <sstream>

#include "host/link/wall_clock.h"
#include "shared/base/files.hpp"
#include "tools/base/child.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/eval/tasks.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kLook{2};
// Looks in which Slurm knows nothing of the job before it counts as ended: squeue shows a requeued task
// at once, but a controller that starts anew shows none for a moment.
constexpr int kLooks = 3;

constexpr std::chrono::seconds kAnswer{1}, kMostWait{600};  // for an answer of Slurm
constexpr int kNoProgram = 127;                             // Child's, as a shell's

struct Ran {
  int status = 0;
  std::string output;  // of both streams
};

// Runs a program of Slurm, which writes its output into the file `log` itself. Ctrl-C goes to kaz alone, and
// `interrupt` ends the waiting; null: a program of Lifetime::own must not be cut off.
Result<Ran> run(const std::string& program, const std::vector<std::string>& arguments,
                const std::string& log, const host::Interrupt* interrupt) {
  auto child = KAZ_TRY(Child::begin(program, arguments, log,
                                    interrupt ? Child::Lifetime::of_parent : Child::Lifetime::own));
  std::optional<int> status;
  for (std::chrono::seconds waited{0}; !(status = child.wait(kAnswer)); waited += kAnswer) {
    if (interrupt && interrupt->requested())
      return fail(Fault::interrupted, "interrupted before " + program + " has answered");
    if (waited >= kMostWait)
      return fail(Fault::environment, program + ": no answer for " +
                                          std::to_string(waited.count()) +
                                          " s; check that Slurm is running");
  }
  const auto output = KAZ_TRY(read_whole_file(log, 1 << 20));
  Ran ran{*status, output};
  while (ran.output.ends_with('\n')) ran.output.pop_back();
  return ran;
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

// The number of a job in what `sbatch --parsable` printed: a line NUMBER or NUMBER;CLUSTER, perhaps among
// warnings. Empty if there is none.
std::string job_in(const std::string& output) {
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    const std::string number = line.substr(0, line.find(';'));
    if (!number.empty() && number.find_first_not_of("0123456789") == std::string::npos)
      return number;
  }
  return "";
}

// sbatch writes this file itself: the job's number is there even if kaz is killed during the submission.
std::string job_file(const std::string& out) {
  return out + "/slurm/job";
}

// The job that an earlier call has submitted. Empty if there is none.
std::string job_of(const std::string& out) {
  return job_in(read_whole_file(job_file(out), 1 << 20).value_or(""));
}

// Whether the job has tasks that wait or run. Errors: Slurm does not answer.
Result<bool> is_under_way(const std::string& out, const std::string& job,
                          const host::Interrupt& interrupt) {
  if (job.empty()) return false;
  const auto ran = KAZ_TRY(run("squeue", {"--noheader", "--jobs", job, "--format", "%T"},
                               out + "/slurm/squeue.out", &interrupt));
  if (ran.status == 0) return !ran.output.empty();
  // Slurm's message for a job that it has forgotten.
  if (ran.output.find("Invalid job id") != std::string::npos) return false;
  return fail(Fault::environment, "squeue: " + first_line(ran.output));
}

Result<std::string> submit(const std::string& out, const SlurmOptions& slurm,
                           const std::vector<int>& tasks) {
  std::vector<std::string> arguments{"--parsable", "--requeue", "--array=" + array_text(tasks),
                                     "--output=" + slurm_pattern(out + "/slurm/") + "%A_%a.out",
                                     "--job-name=kaz"};
  arguments.insert(arguments.end(), slurm.submit.begin(), slurm.submit.end());
  arguments.push_back(out + "/slurm/job.sh");
  const auto ran = KAZ_TRY(run("sbatch", arguments, job_file(out), nullptr));
  if (ran.status == kNoProgram)
    return fail(Fault::environment,
                "--slurm needs the command sbatch, on a machine that submits to a cluster "
                "(Debian: slurm-client)");
  std::string job = job_in(ran.output);
  if (ran.status != 0 || job.empty())
    return fail(Fault::environment, "sbatch refused the job: " + first_line(ran.output) +
                                        " (options for it: --sbatch; its script: " + out +
                                        "/slurm/job.sh)");
  return job;
}

}  // namespace

std::string slurm_script(const std::string& program, const std::vector<std::string>& words,
                         const std::string& folder, int tasks, int jobs) {
  const TaskScript by{"#SBATCH --cpus-per-task=" + std::to_string(jobs) + "\n",
                      "$SLURM_ARRAY_TASK_ID", "$SLURM_JOB_ID.${SLURM_RESTART_COUNT:-0}.$$"};
  return task_script(by, program, words, folder, tasks);
}

// Slurm's documentation: %% is a percent sign, and a backslash switches off all symbols.
std::string slurm_pattern(const std::string& path) {
  std::string pattern;
  for (const char c : path) pattern += c == '%' ? std::string("%%") : std::string(1, c);
  return pattern;
}

Result<bool> run_on_slurm(const CampaignOptions& options, const SlurmOptions& slurm) {
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  std::error_code wrong;
  const std::string out = fs::absolute(options.out, wrong).lexically_normal().string();
  if (out.find('\\') != std::string::npos)
    return fail(Fault::usage, "--out: '" + out +
                                  "' contains a backslash, which Slurm does not allow in names of "
                                  "output files: choose another folder");
  const std::string program = fs::read_symlink("/proc/self/exe", wrong).string();
  const auto folder = KAZ_TRY(open_campaign(out));
  const std::string script =
      slurm_script(program, task_words(slurm.words), out, slurm.tasks, options.jobs);
  KAZ_TRY(write_task_script(out, "slurm", "job.sh", script));

  std::string job = job_of(out);
  std::vector<int> missing = without_part(out, slurm.tasks);
  if (!missing.empty() && !KAZ_TRY(is_under_way(out, job, interrupt))) {
    remove_unfinished(out, slurm.tasks);
    job = KAZ_TRY(submit(out, slurm, missing));
    if (!options.json)
      std::printf("job %s: %s of %d\n", job.c_str(), task_list(missing).c_str(), slurm.tasks);
  } else if (!missing.empty() && !options.json) {
    std::printf("job %s is still running\n", job.c_str());
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
      return fail(Fault::interrupted,
                  "interrupted; job " + job +
                      " continues: the same command waits for the job, and `scancel " + job +
                      "` cancels the job");
    }
    const auto under_way = is_under_way(out, job, interrupt);
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
      progress.announce(0, "the new job " + job + " runs " + task_list(missing) + " again");
      continue;
    }
    progress.done();
    return fail(Fault::environment, task_list(missing) + " of job " + job +
                                        " ended without a result: see " + out + "/slurm/" + job +
                                        "_" + std::to_string(missing.front()) +
                                        ".out; the same command submits these tasks again");
  }
  progress.done();
  return merge_tasks(folder, slurm.tasks, options.json);
}

}  // namespace kaz::tools
