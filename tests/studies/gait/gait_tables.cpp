// gait_tables: many runs of the known gait under several steppers, and their tables.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include <CLI/CLI.hpp>

#include "tests/studies/gait/report.h"
#include "tools/figure/figure.h"
#include "tools/trials/run_jobs.h"

namespace {

using namespace kaz;
using namespace kaz::gait;

struct Arguments {
  int seeds = 50, first_seed = 1, jobs = 2;
  std::string rows, steppers = "reduced,exact", out = "out/gait", lines, motors = "product";
  std::string engine = "h8";
  bool list = false, only_report = false;
};

const std::map<std::string, Motors> kMotors{
    {"product", Motors::product}, {"ideal", Motors::ideal}, {"reference", Motors::reference}};

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream in(list);
  for (std::string part; std::getline(in, part, ',');)
    if (!part.empty()) parts.push_back(part);
  return parts;
}

struct Job {
  const Task* task;
  Key key;
};

// Seed by seed, so that a table of a run that was interrupted has about as many of each row.
std::vector<Job> jobs_of(const Arguments& arguments, const std::vector<Task>& chosen,
                         const Results& results) {
  std::vector<Job> jobs;
  for (int seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    for (const Task& task : chosen) {
      for (const std::string& stepper : split(arguments.steppers)) {
        Key key{task.name, stepper, static_cast<std::uint64_t>(seed)};
        if (!results.has(key)) jobs.push_back({&task, std::move(key)});
      }
    }
  }
  return jobs;
}

Result<void> work(const Arguments& arguments, const std::vector<Job>& jobs, Results& results) {
  std::size_t done = 0;
  return trials::run_jobs(jobs.size(), arguments.jobs, [&](std::size_t i) {
    const Job& job = jobs[i];
    const Setting setting{.stepper = job.key.stepper,
                          .engine = arguments.engine,
                          .image_path = KAZ_FIRMWARE_IMAGE,
                          .robot_folder = KAZ_ROBOT,
                          .motors = kMotors.at(arguments.motors)};
    return
        [&, &job = job, outcome = run_episode(*job.task, setting, job.key.seed)]() -> Result<void> {
          // A setting that is wrong is so for all.
          if (!outcome && outcome.error().fault == Fault::usage)
            return tl::unexpected(outcome.error());
          std::fprintf(stderr, "gait %zu/%zu: %s, %s, seed %llu%s\n", ++done, jobs.size(),
                       job.key.task.c_str(), job.key.stepper.c_str(),
                       static_cast<unsigned long long>(job.key.seed),
                       !outcome          ? (": " + outcome.error().message).c_str()
                       : outcome->fell   ? ": fell"
                       : outcome->caught ? ": caught"
                                         : "");
          return results.add(job.key,
                             outcome ? Entry{*outcome, ""} : Entry{{}, outcome.error().message});
        };
  });
}

Result<void> write(const std::string& path, const std::string& text) {
  return figure::write_file(path,
                            {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

Result<void> run(const Arguments& arguments) {
  std::vector<Task> chosen;
  try {
    const std::regex wanted(arguments.rows);
    std::ranges::copy_if(tasks(), std::back_inserter(chosen),
                         [&](const Task& task) { return std::regex_search(task.name, wanted); });
  } catch (const std::regex_error&) {
    return fail(Fault::usage, "--rows " + arguments.rows + " is no regular expression; see --help");
  }
  if (chosen.empty())
    return fail(Fault::usage, "--rows " + arguments.rows + " fits no row; see --list");
  if (arguments.list) {
    for (const Task& task : chosen) std::printf("%s\n", task.name.c_str());
    return {};
  }
  std::error_code wrong;
  std::filesystem::create_directories(arguments.out, wrong);
  if (wrong) return fail(Fault::environment, arguments.out + ": " + wrong.message());
  auto results =
      Results::open(arguments.lines.empty() ? arguments.out + "/episodes.jsonl" : arguments.lines,
                    arguments.motors);
  if (!results) return tl::unexpected(results.error());
  if (!arguments.only_report) {
    if (auto done = work(arguments, jobs_of(arguments, chosen, *results), *results); !done)
      return done;
  }
  const std::vector<std::string> steppers = split(arguments.steppers);
  const std::string text = tables(*results, chosen, steppers);
  std::printf("%s", text.c_str());
  if (auto done = write(arguments.out + "/tables.md", text); !done) return done;
  if (auto done = write(arguments.out + "/tables.json", summary_json(*results, chosen, steppers));
      !done) {
    return done;
  }
  return pictures(*results, chosen, steppers, arguments.out);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Walking, pushes, turning by slip and catching, through host, wire and firmware, under "
      "several steppers of the dynamics. What is finished is kept and not run again.");
  app.add_option("--seeds", arguments.seeds, "runs of each row under each stepper")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--first-seed", arguments.first_seed, "of them")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  app.add_option("--rows", arguments.rows, "regular expression: rows whose name has it");
  app.add_option("--steppers", arguments.steppers, "with commas: reduced, exact, quickN")
      ->capture_default_str();
  app.add_option(
         "--motors", arguments.motors,
         "product: as motor.xml has them; ideal: without backlash and heat; reference: those "
         "that the gait was found with")
      ->check(CLI::IsMember(kMotors))
      ->capture_default_str();
  app.add_option("--engine", arguments.engine,
                 "h8: emulated firmware; native: the same C, compiled")
      ->check(CLI::IsMember({"h8", "native"}))
      ->capture_default_str();
  app.add_option("--jobs", arguments.jobs, "threads")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--out", arguments.out, "folder of tables.md, tables.json and pictures")
      ->capture_default_str();
  app.add_option("--json", arguments.lines,
                 "file of the episodes, one JSON object a line (default: episodes.jsonl in --out)");
  app.add_flag("--list", arguments.list, "names of the rows, no more");
  app.add_flag("--report", arguments.only_report, "tables of what is there, no runs");
  app.footer(
      "gait_tables --seeds 5 --rows '^turn' --steppers reduced\ngait_tables --motors ideal --out "
      "out/gait-ideal");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  const auto done = run(arguments);
  if (done) return 0;
  std::fprintf(stderr, "gait_tables: %s\n", done.error().message.c_str());
  return static_cast<int>(done.error().fault);
}
