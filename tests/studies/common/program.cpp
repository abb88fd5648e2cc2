// Options, resuming, progress, files of results, provenance.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/common/program.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <regex>

#include <CLI/CLI.hpp>

#include "shared/base/files.hpp"
#include "tests/studies/common/run_jobs.h"

namespace kaz::studies {
namespace {

std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789-_=+.,:/@%") == std::string::npos;
  return plain ? word : "'" + std::regex_replace(word, std::regex("'"), R"('\'')") + "'";
}

// Reproducible builds' convention: https://reproducible-builds.org/specs/source-date-epoch/
std::string date() {
  std::time_t time = std::time(nullptr);
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH"); epoch != nullptr)
    time = static_cast<std::time_t>(std::strtoll(epoch, nullptr, 10));
  std::tm utc{};
  gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d", &utc);
  return text;
}

// Abbreviated id, "-dirty" where files differ from it; empty without git or outside a repository.
std::string commit() {
  const auto close = [](std::FILE* pipe) { pclose(pipe); };
  // A command without input from outside. NOLINTNEXTLINE(cert-env33-c)
  const std::unique_ptr<std::FILE, decltype(close)> pipe(
      popen("git describe --always --dirty --abbrev=12 --exclude='*' 2>/dev/null", "r"), close);
  std::array<char, 64> line{};
  if (!pipe || std::fgets(line.data(), line.size(), pipe.get()) == nullptr) return "";
  std::string id = line.data();
  id.erase(id.find_last_not_of('\n') + 1);
  return id;
}

Result<void> make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Fault::environment, folder + ": cannot be created: " + error.message());
  return {};
}

struct Job {
  std::size_t row;
  EpisodeKey key;
};

std::vector<Job> missing(const EpisodeStudy& study, const EpisodeOptions& options,
                         const EpisodeFile& file) {
  std::vector<Job> jobs;
  for (int seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed) {
    for (std::size_t row = 0; row < study.rows.size(); ++row) {
      for (const std::string& variant : study.variants) {
        EpisodeKey key{study.rows[row], variant, static_cast<std::uint64_t>(seed)};
        if (!file.has(key)) jobs.push_back({row, std::move(key)});
      }
    }
  }
  return jobs;
}

Result<void> run_missing(const EpisodeStudy& study, const EpisodeOptions& options,
                         EpisodeFile& file) {
  const std::vector<Job> jobs = missing(study, options, file);
  std::size_t done = 0;
  return run_jobs(jobs.size(), options.jobs, [&](std::size_t i) {
    const Job& job = jobs[i];
    return [&, &job = job, outcome = study.run(job.row, job.key)]() -> Result<void> {
      // Wrong settings are wrong for all episodes.
      if (!outcome && outcome.error().fault == Fault::usage) return tl::unexpected(outcome.error());
      std::fprintf(
          stderr, "%s %zu/%zu: %s, %s, seed %llu: %s\n", study.name.c_str(), ++done, jobs.size(),
          job.key.row.c_str(), job.key.variant.c_str(),
          static_cast<unsigned long long>(job.key.seed),
          outcome ? study.describe(job.row, *outcome).c_str() : outcome.error().message.c_str());
      return file.add(job.key,
                      outcome ? Episode{*outcome, ""} : Episode{{}, outcome.error().message});
    };
  });
}

}  // namespace

std::string command_line(int argc, const char* const* argv) {
  std::string line = std::filesystem::path(argv[0]).filename().string();
  for (int i = 1; i < argc; ++i) line += " " + quoted(argv[i]);
  return line;
}

std::string provenance(const std::string& command, const std::string& amount) {
  const std::string id = commit();
  return "Measured by `" + command + "` on " + date() + (id.empty() ? "" : " at commit " + id) +
         ", " + amount + ".\n";
}

void add_markdown_option(CLI::App& app, std::string& file) {
  app.add_option("--markdown", file,
                 "file for the tables, below a line with command, date, commit and number of runs");
}

Result<void> write_markdown(const std::string& file, const std::string& command,
                            const std::string& amount, const std::string& tables) {
  if (file.empty()) return {};
  const std::string gap = tables.starts_with('\n') ? "" : "\n";
  return write_whole_file(file, provenance(command, amount) + gap + tables);
}

Result<void> write_tables(const std::string& folder, const std::string& name,
                          const std::string& markdown, const std::string& json) {
  if (auto made = make_folder(folder); !made) return made;
  if (auto done = write_whole_file(folder + "/" + name + ".md", markdown); !done) return done;
  return write_whole_file(folder + "/" + name + ".json", json);
}

int run_program(CLI::App& app, const std::string& name, int argc, char** argv,
                const std::function<Result<void>()>& run) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : static_cast<int>(Fault::usage);
  }
  const auto done = run();
  if (done) return 0;
  std::fprintf(stderr, "%s: %s\n", name.c_str(), done.error().message.c_str());
  return static_cast<int>(done.error().fault);
}

void add_episode_options(CLI::App& app, EpisodeOptions& options) {
  app.add_option("--seeds", options.seeds, "episodes of each row and variant")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "the seeds begin with it")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  app.add_option("--rows", options.rows, "regular expression: only rows whose name matches");
  app.add_option("--jobs", options.jobs, "threads")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--out", options.out, "folder for tables and plots")->capture_default_str();
  app.add_option("--json", options.episodes,
                 "file of the episodes, one JSON object a line (default: episodes.jsonl in --out)");
  add_markdown_option(app, options.markdown);
  app.add_flag("--list", options.list, "print the names of the rows and exit");
  app.add_flag("--report", options.only_report, "tables of the episodes in the file; run none");
}

Result<std::vector<std::size_t>> matching(const std::vector<std::string>& names,
                                          const std::string& expression) {
  std::vector<std::size_t> found;
  try {
    const std::regex wanted(expression);
    for (std::size_t i = 0; i < names.size(); ++i)
      if (std::regex_search(names[i], wanted)) found.push_back(i);
  } catch (const std::regex_error&) {
    return fail(Fault::usage, "--rows " + expression + " is not a regular expression; see --help");
  }
  if (found.empty())
    return fail(Fault::usage, "--rows " + expression + " matches no row; see --list");
  return found;
}

Result<EpisodeFile> run_study(const EpisodeStudy& study, const EpisodeOptions& options) {
  KAZ_TRY(make_folder(options.out));
  auto file = EpisodeFile::open(
      options.episodes.empty() ? options.out + "/episodes.jsonl" : options.episodes, study.motors);
  if (!file || options.only_report) return file;
  KAZ_TRY(run_missing(study, options, *file));
  return file;
}

}  // namespace kaz::studies
