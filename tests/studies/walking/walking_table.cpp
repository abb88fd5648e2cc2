// walking_table: many runs of the walking behaviours, and their table.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <regex>

#include <CLI/CLI.hpp>

#include "tests/studies/walking/score.h"
#include "tools/figure/figure.h"
#include "tools/trials/run_jobs.h"

namespace {

using namespace kaz;
using namespace kaz::walking;

struct Arguments {
  int seeds = 20, first_seed = 1, jobs = 1;
  std::string rows, out = "out/walking", lines, engine = "h8";
  bool list = false, only_report = false, trace = false;
};

struct Job {
  const Trial* trial;
  gait::Key key;
};

// Seed by seed, so that a table of a run that was interrupted has about as many of each row.
std::vector<Job> jobs_of(const Arguments& arguments, const std::vector<Trial>& chosen,
                         const gait::Results& results) {
  std::vector<Job> jobs;
  for (int seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    for (const Trial& trial : chosen) {
      gait::Key key{trial.name, arguments.engine, static_cast<std::uint64_t>(seed)};
      if (!results.has(key)) jobs.push_back({&trial, std::move(key)});
    }
  }
  return jobs;
}

Result<void> work(const Arguments& arguments, const std::vector<Job>& jobs,
                  gait::Results& results) {
  std::size_t done = 0;
  return trials::run_jobs(jobs.size(), arguments.jobs, [&](std::size_t i) {
    const Job& job = jobs[i];
    const Setting setting{.engine = arguments.engine,
                          .image_path = KAZ_FIRMWARE_IMAGE,
                          .robot_folder = KAZ_ROBOT,
                          .trace = arguments.trace};
    return [&, &job = job,
            outcome = run_trial(*job.trial, setting, job.key.seed)]() -> Result<void> {
      // A setting that is wrong is so for all.
      if (!outcome && outcome.error().fault == Fault::usage) return tl::unexpected(outcome.error());
      std::fprintf(stderr, "walking %zu/%zu: %s, seed %llu: ", ++done, jobs.size(),
                   job.key.task.c_str(), static_cast<unsigned long long>(job.key.seed));
      if (outcome) {
        std::fprintf(stderr, "%s %.3f m, aside %+.3f m, heading %+.2f deg, %.1f s\n",
                     outcome->fell                     ? "FELL"
                     : succeeded(*job.trial, *outcome) ? "done"
                                                       : "MISSED",
                     outcome->forward_m, outcome->aside_m, outcome->heading_deg, outcome->seconds);
      } else {
        std::fprintf(stderr, "%s\n", outcome.error().message.c_str());
      }
      return results.add(
          job.key, outcome ? gait::Entry{*outcome, ""} : gait::Entry{{}, outcome.error().message});
    };
  });
}

Result<void> write(const std::string& path, const std::string& text) {
  return figure::write_file(path,
                            {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

Result<void> run(const Arguments& arguments) {
  std::vector<Trial> chosen;
  try {
    const std::regex wanted(arguments.rows);
    std::ranges::copy_if(walking::trials(), std::back_inserter(chosen),
                         [&](const Trial& trial) { return std::regex_search(trial.name, wanted); });
  } catch (const std::regex_error&) {
    return fail(Fault::usage, "--rows " + arguments.rows + " is no regular expression; see --help");
  }
  if (chosen.empty())
    return fail(Fault::usage, "--rows " + arguments.rows + " fits no row; see --list");
  if (arguments.list) {
    for (const Trial& trial : chosen) std::printf("%s\n", trial.name.c_str());
    return {};
  }
  std::error_code wrong;
  std::filesystem::create_directories(arguments.out, wrong);
  if (wrong) return fail(Fault::environment, arguments.out + ": " + wrong.message());
  auto results = gait::Results::open(
      arguments.lines.empty() ? arguments.out + "/episodes.jsonl" : arguments.lines, "product");
  if (!results) return tl::unexpected(results.error());
  if (!arguments.only_report) {
    if (auto done = work(arguments, jobs_of(arguments, chosen, *results), *results); !done)
      return done;
  }
  std::string text = table(*results, chosen, arguments.engine);
  if (const std::string believed = odometry_table(*results, chosen, arguments.engine);
      !believed.empty()) {
    text += "\n" + believed;
  }
  std::printf("%s", text.c_str());
  if (auto done = write(arguments.out + "/table.md", text); !done) return done;
  if (auto done =
          write(arguments.out + "/table.json", summary_json(*results, chosen, arguments.engine));
      !done) {
    return done;
  }
  return pictures(*results, arguments.engine, arguments.out);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "go-forward and the turns through host, wire and firmware, by seeds, friction and supply, "
      "with "
      "and without gyro. What is finished is kept and not run again.");
  app.add_option("--seeds", arguments.seeds, "runs of each row")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--first-seed", arguments.first_seed, "of them")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  app.add_option("--rows", arguments.rows, "regular expression: rows whose name has it");
  app.add_option("--engine", arguments.engine,
                 "h8: emulated firmware; native: the same C, compiled")
      ->check(CLI::IsMember({"h8", "native"}))
      ->capture_default_str();
  app.add_option("--jobs", arguments.jobs, "threads")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--out", arguments.out, "folder of table.md, table.json and pictures")
      ->capture_default_str();
  app.add_option("--json", arguments.lines,
                 "file of the episodes, one JSON object a line (default: episodes.jsonl in --out)");
  app.add_flag("--list", arguments.list, "names of the rows, no more");
  app.add_flag("--report", arguments.only_report, "the table of what is there, no runs");
  app.add_flag("--trace", arguments.trace, "where the robot is, each 0.4 s, on standard error");
  app.footer("walking_table --seeds 5 --rows '^walk 1 m$'");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  const auto done = run(arguments);
  if (done) return 0;
  std::fprintf(stderr, "walking_table: %s\n", done.error().message.c_str());
  return static_cast<int>(done.error().fault);
}
