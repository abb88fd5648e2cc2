// Common to all study programs: options, resuming, progress, result files and provenance.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tests/studies/common/episode_file.h"

namespace CLI {
class App;
}

namespace kaz::studies {

// Returns the program's name without folder, and its arguments, quoted for a shell if necessary.
std::string command_line(int argc, const char* const* argv);

// Returns the first line of a result file: "Measured by `COMMAND` on YYYY-MM-DD at commit ID, AMOUNT." The
// date is that of SOURCE_DATE_EPOCH or today, UTC. The commit is left out without git or a repository.
// `amount`: how much was measured, such as "50 seeds".
std::string provenance(const std::string& command, const std::string& amount);

// Adds --markdown FILE: tables below a line of provenance().
void add_markdown_option(CLI::App& app, std::string& file);
// Writes the file of add_markdown_option(). Does nothing if `file` is empty.
Result<void> write_markdown(const std::string& file, const std::string& command,
                            const std::string& amount, const std::string& tables);
// Writes FOLDER/NAME.md and FOLDER/NAME.json. Creates the folder.
Result<void> write_tables(const std::string& folder, const std::string& name,
                          const std::string& markdown, const std::string& json);

// Parses the arguments and calls `run`. Prints an error as "NAME: sentence". Returns the exit code: 0, or the
// number of the error's fault. Errors of the parser are Fault::usage.
int run_program(CLI::App& app, const std::string& name, int argc, char** argv,
                const std::function<Result<void>()>& run);

// Options of a study that runs many episodes.
struct EpisodeOptions {
  int seeds = 50, first_seed = 1, jobs = 1;
  std::string rows = {};      // regular expression
  std::string out = {};       // folder for tables and plots
  std::string episodes = {};  // file; empty: episodes.jsonl in `out`
  std::string markdown = {};  // file
  bool list = false, only_report = false;
};
void add_episode_options(CLI::App& app, EpisodeOptions& options);

// Returns the indices of the names that match the regular expression. Returns Fault::usage if it is invalid
// or matches no name.
Result<std::vector<std::size_t>> matching(const std::vector<std::string>& names,
                                          const std::string& expression);

// Returns the rows whose `name` matches.
template <class Row>
Result<std::vector<Row>> matching_rows(const std::vector<Row>& all, const std::string& expression) {
  std::vector<std::string> names;
  for (const Row& row : all) names.push_back(row.name);
  const auto indices = KAZ_TRY(matching(names, expression));
  std::vector<Row> rows;
  for (const std::size_t i : indices) rows.push_back(all[i]);
  return rows;
}

struct EpisodeStudy {
  std::string name = {};                              // program name for progress messages
  std::string motors = "product";                     // for EpisodeFile::open()
  std::vector<std::string> rows = {}, variants = {};  // each row is run under each variant
  // Runs one episode; called from several threads.
  std::function<Result<Outcome>(std::size_t row, const EpisodeKey&)> run = {};
  // Describes the outcome in a progress message.
  std::function<std::string(std::size_t row, const Outcome&)> describe = {};
};

// Creates the folder `out`, opens the file of episodes, and runs the missing episodes on `options.jobs`
// threads. Runs seed by seed, so that an interrupted study has about equally many episodes of each row. Adds
// each outcome to the file at once, also one that is an error. But Fault::usage ends the study.
Result<EpisodeFile> run_study(const EpisodeStudy& study, const EpisodeOptions& options);

}  // namespace kaz::studies
