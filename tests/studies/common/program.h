// What every study program does: options, resuming, progress, files of results, provenance.
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

// The part of a path behind its last slash, and arguments, quoted where a shell needs it.
std::string command_line(int argc, const char* const* argv);

// "Measured by `COMMAND` on YYYY-MM-DD at commit ID, N seeds.": the first line of a file of results. The
// date is SOURCE_DATE_EPOCH's or today's, UTC; without git or a repository there is no commit. `amount`
// says how much was measured, "50 seeds".
std::string provenance(const std::string& command, const std::string& amount);

// Adds --markdown FILE: tables below a line of provenance().
void add_markdown_option(CLI::App& app, std::string& file);
// Writes that file; does nothing where `file` is empty.
Result<void> write_markdown(const std::string& file, const std::string& command,
                            const std::string& amount, const std::string& tables);
// FOLDER/NAME.md and FOLDER/NAME.json; makes the folder.
Result<void> write_tables(const std::string& folder, const std::string& name,
                          const std::string& markdown, const std::string& json);

// Parses the arguments and runs. Prints an error as "NAME: sentence". Returns the exit code: 0, or the
// number of the error's fault; usage errors of the parser are Fault::usage.
int run_program(CLI::App& app, const std::string& name, int argc, char** argv,
                const std::function<Result<void>()>& run);

// Options of a study that runs many episodes.
struct EpisodeOptions {
  int seeds = 50, first_seed = 1, jobs = 1;
  std::string rows = {};      // regular expression
  std::string out = {};       // folder of tables and plots
  std::string episodes = {};  // file; empty: episodes.jsonl in `out`
  std::string markdown = {};  // file
  bool list = false, only_report = false;
};
void add_episode_options(CLI::App& app, EpisodeOptions& options);

// Indices of the names that match the regular expression. Errors (usage): not a regular expression, no match.
Result<std::vector<std::size_t>> matching(const std::vector<std::string>& names,
                                          const std::string& expression);

// Rows whose `name` matches.
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
  std::string name = {};                              // of the program, for progress messages
  std::string motors = "product";                     // (EpisodeFile::open)
  std::vector<std::string> rows = {}, variants = {};  // each row is run under each variant
  // Runs one episode; called from several threads.
  std::function<Result<Outcome>(std::size_t row, const EpisodeKey&)> run = {};
  // The outcome in a progress message.
  std::function<std::string(std::size_t row, const Outcome&)> describe = {};
};

// Opens the file of episodes, makes the folder `out`, and runs the episodes that the file does not have, on
// `options.jobs` threads, seed by seed: an interrupted study has about as many episodes of each row. Each
// outcome is added to the file at once. Episodes that end in an error are kept with it, but an error of
// usage ends the study.
Result<EpisodeFile> run_study(const EpisodeStudy& study, const EpisodeOptions& options);

}  // namespace kaz::studies
