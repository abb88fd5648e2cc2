// contact_table: fits contact parameters of physics engines to recorded tosses, and prints their scores.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <CLI/CLI.hpp>

#include "shared/base/files.hpp"
#include "tests/studies/common/program.h"
#include "tests/studies/contact/report.h"

namespace {

using namespace kaz;
using namespace kaz::contact;

struct Options {
  std::string folder, out, fits, markdown;
  std::vector<std::string> engines = engine_names();
  FitOptions fit;
  int steps = 10;
  bool json = false, correct = false;
};

void add_options(CLI::App& program, Options& options) {
  program.add_option("folder", options.folder, "folder with the tosses NUMBER.csv")->required();
  program.add_option("--out", options.out, "folder for contact.md, .json, .csv and the pictures");
  program.add_flag("--json", options.json, "print JSON instead of the tables");
  program
      .add_option("--engines", options.engines,
                  "rows: reduced, exact, quickN (N iterations), mujoco; the ratio needs mujoco")
      ->delimiter(',')
      ->capture_default_str();
  program
      .add_option("--generations", options.fit.generations,
                  "generations of the fit; each simulates all tosses of a fold 8 times")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  program.add_option("--seed", options.fit.seed, "seed of fit and bootstrap")
      ->capture_default_str();
  program.add_option("--jobs", options.fit.jobs, "threads")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  program.add_option("--steps", options.steps, "physics steps in a sample of 1/148 s")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  program.add_option("--fits", options.fits,
                     "contact.json of an earlier run: judge with its values, fit nothing");
  program.add_flag("--correct-velocity", options.correct,
                   "start with the velocity at the sample, not half a sample earlier as recorded");
  studies::add_markdown_option(program, options.markdown);
}

Result<Row> make_row(const Options& options, const std::string& name, const std::string& fits,
                     std::span<const Toss> tosses) {
  Row row{KAZ_TRY(engine_of(name, options.steps)), {}, {}};
  const auto progress = [](const std::string& message) {
    std::fprintf(stderr, "contact_table: %s\n", message.c_str());
  };
  row.fits = fits.empty() ? KAZ_TRY(fit_folds(row.engine, tosses, options.fit, progress))
                          : KAZ_TRY(read_fits(fits, options.fits, row.engine));
  row.judged = KAZ_TRY(
      judge(row.engine, tosses, {row.fits[0].values, row.fits[1].values}, options.fit.jobs));
  return row;
}

Result<void> write_all(const std::string& out, std::span<const Row> rows,
                       std::span<const Toss> tosses, std::uint64_t seed) {
  KAZ_TRY(studies::write_tables(out, "contact", markdown(rows, seed), json(rows, tosses, seed)));
  KAZ_TRY(write_whole_file(out + "/contact.csv", csv(rows, tosses)));
  return write_pictures(out, rows, tosses);
}

Result<void> run(const Options& options, const std::string& command) {
  auto tosses = KAZ_TRY(read_tosses(options.folder));
  if (options.correct) correct_velocities(tosses);
  constexpr std::size_t kMostJson = 8u << 20;
  const std::string fits =
      options.fits.empty() ? "" : KAZ_TRY(read_whole_file(options.fits, kMostJson));
  std::vector<Row> rows;
  for (const std::string& name : options.engines) {
    rows.push_back(KAZ_TRY(make_row(options, name, fits, tosses)));
    if (!options.out.empty()) KAZ_TRY(write_all(options.out, rows, tosses, options.fit.seed));
  }
  const std::string tables = markdown(rows, options.fit.seed);
  std::printf("%s", (options.json ? json(rows, tosses, options.fit.seed) : tables).c_str());
  return studies::write_markdown(options.markdown, command,
                                 std::to_string(tosses.size()) + " tosses", tables);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{
      "Fits the contact parameters of physics engines to recorded tosses of a cube in two folds, "
      "and "
      "prints the score of each engine over all tosses (minutes).\n"
      "  contact_table tosses --out out/contact"};
  Options options;
  add_options(program, options);
  return studies::run_program(program, "contact_table", argc, argv,
                              [&] { return run(options, studies::command_line(argc, argv)); });
}
