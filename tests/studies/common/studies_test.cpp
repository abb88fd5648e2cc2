// Tables, provenance, options, resumed files and parallel jobs of the study programs.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include <CLI/CLI.hpp>

#include "shared/base/files.hpp"
#include "tests/studies/common/program.h"
#include "tests/studies/common/run_jobs.h"
#include "tests/studies/common/table.h"

namespace kaz::studies {
namespace {

namespace fs = std::filesystem;

// A folder that is removed with the object.
class Folder {
 public:
  Folder() : path_(make_temporary_folder("kaz-studies-").value()) {}
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

std::string read(const std::string& path) {
  const auto bytes = read_whole_file(path, 1 << 20);
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes.value_or("");
}

TEST(StudyTable, PadsRowsToTheHeading) {
  MarkdownTable table({"trial", "falls", "time, s"});
  EXPECT_TRUE(table.empty());
  table.add({"walk", text("%d of %d", 1, 20), text("%.1f", 12.34)});
  table.add({"turn"});
  EXPECT_EQ(table.text(),
            "| trial | falls | time, s |\n| --- | --- | --- |\n"
            "| walk | 1 of 20 | 12.3 |\n| turn |  |  |\n");
  EXPECT_EQ(percent(1, 4), 25);
  EXPECT_EQ(percent(0, 0), 0);
}

TEST(StudyProgram, ProvenanceHasCommandDateAndAmount) {
  const char* const arguments[] = {"build/release/bin/gait_tables", "--rows", "^walk 1 m$",
                                   "--it's"};
  const std::string command = command_line(4, arguments);
  EXPECT_EQ(command, R"(gait_tables --rows '^walk 1 m$' '--it'\''s')");
  ASSERT_EQ(setenv("SOURCE_DATE_EPOCH", "86400", 1), 0);
  const Folder folder;
  ASSERT_TRUE(write_markdown(folder / "table.md", command, "50 seeds", "| a |\n"));
  unsetenv("SOURCE_DATE_EPOCH");
  const std::string written = read(folder / "table.md");
  EXPECT_TRUE(written.starts_with("Measured by `" + command + "` on 1970-01-02")) << written;
  EXPECT_TRUE(written.ends_with(", 50 seeds.\n\n| a |\n")) << written;
  EXPECT_TRUE(write_markdown("", command, "", "")) << "no file: nothing to do";
  EXPECT_FALSE(write_markdown(folder / "none/table.md", command, "", ""));
}

TEST(StudyProgram, ErrorsAreExitCodes) {
  const auto exit_code = [](std::vector<std::string> words, const Result<void>& result) {
    CLI::App app;
    EpisodeOptions options;
    add_episode_options(app, options);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    return run_program(app, "study", static_cast<int>(argv.size()), argv.data(),
                       [&] { return result; });
  };
  EXPECT_EQ(exit_code({"study"}, {}), 0);
  EXPECT_EQ(exit_code({"study", "--help"}, fail(Fault::failed, "is not run")), 0);
  EXPECT_EQ(exit_code({"study", "--seeds", "0"}, {}), 2);
  EXPECT_EQ(exit_code({"study"}, fail(Fault::environment, "no disk")), 3);
}

struct Named {
  std::string name;
};

TEST(StudyProgram, SelectsRowsByRegularExpression) {
  const std::vector<Named> all{{"walk 1 m"}, {"turn +45"}, {"walk 2 m"}};
  const auto walks = matching_rows(all, "^walk");
  ASSERT_TRUE(walks);
  ASSERT_EQ(walks->size(), 2u);
  EXPECT_EQ((*walks)[1].name, "walk 2 m");
  EXPECT_EQ(matching_rows(all, "").value().size(), 3u);
  EXPECT_FALSE(matching_rows(all, "jump"));
  EXPECT_FALSE(matching_rows(all, "("));
}

TEST(StudyProgram, ResumesWhereItWasInterrupted) {
  const Folder folder;
  std::atomic<int> runs = 0;
  EpisodeStudy study{.name = "study", .rows = {"a", "b"}, .variants = {"x", "y"}};
  study.run = [&runs](std::size_t row, const EpisodeKey& key) -> Result<Outcome> {
    ++runs;
    if (key.seed == 2 && key.variant == "y") return fail(Fault::failed, "the board stopped");
    return Outcome{.seconds = static_cast<double>(row)};
  };
  study.describe = [](std::size_t, const Outcome&) { return std::string("done"); };
  EpisodeOptions options{.seeds = 1, .jobs = 2, .out = folder / "out"};
  const auto first = run_study(study, options);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(runs, 4);
  options.seeds = 2;
  const auto second = run_study(study, options);
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_EQ(runs, 8) << "of the first seed nothing is run again";
  EXPECT_EQ(second->seeds(), 2u);
  EXPECT_EQ(second->outcomes("b", "x").size(), 2u);
  EXPECT_EQ(second->outcomes("b", "x")[1].seconds, 1);
  EXPECT_EQ(second->outcomes("b", "y").size(), 1u);
  EXPECT_EQ(second->errors("b", "y"), 1);
  options.seeds = 3;
  options.only_report = true;
  EXPECT_EQ(run_study(study, options).value().seeds(), 2u);
  EXPECT_EQ(runs, 8);
}

TEST(StudyProgram, AnErrorOfUsageEndsTheStudy) {
  const Folder folder;
  EpisodeStudy study{.name = "study", .rows = {"a"}, .variants = {"x"}};
  study.run = [](std::size_t, const EpisodeKey&) -> Result<Outcome> {
    return fail(Fault::usage, "no such dynamics");
  };
  study.describe = [](std::size_t, const Outcome&) { return std::string(); };
  const auto done = run_study(study, {.seeds = 5, .out = folder / "out"});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "no such dynamics");
  EXPECT_FALSE(fs::exists(folder / "out/episodes.jsonl"));
}

TEST(EpisodeFile, KeepsOutcomesAndNeverMixesMotors) {
  const Folder folder;
  const std::string path = folder / "episodes.jsonl";
  Episode episode;
  episode.outcome.heading_deg = 12.5;
  episode.outcome.per_cycle_deg = {24, 25};
  episode.outcome.path = {{1.5, -2.5}};
  episode.outcome.reported = {{"ahead_m", 0.5}};
  {
    auto file = EpisodeFile::open(path, "product");
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->add({"a", "exact", 7}, episode));
    ASSERT_TRUE(file->add({"a", "exact", 8}, {{}, "no answer"}));
  }
  std::ofstream(path, std::ios::app) << R"({"row":"a","var)";  // interrupted while writing
  const auto file = EpisodeFile::open(path, "product");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->has({"a", "exact", 7}));
  EXPECT_FALSE(file->has({"a", "reduced", 7}));
  EXPECT_EQ(file->errors("a", "exact"), 1);
  const auto outcomes = file->outcomes("a", "exact");
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].per_cycle_deg, episode.outcome.per_cycle_deg);
  EXPECT_EQ(outcomes[0].path, episode.outcome.path);
  EXPECT_EQ(outcomes[0].reported, episode.outcome.reported);
  EXPECT_FALSE(EpisodeFile::open(path, "ideal")) << "of other motors";
  std::ofstream(path, std::ios::app) << "{}\n";
  EXPECT_FALSE(EpisodeFile::open(path, "product"));
}

TEST(RunJobs, RunsEachJobOnceAndStopsAtTheFirstError) {
  std::set<std::size_t> done;
  EXPECT_TRUE(run_jobs(50, 3, [&](std::size_t i) {
    return [&done, i]() -> Result<void> {
      EXPECT_TRUE(done.insert(i).second);
      return {};
    };
  }));
  EXPECT_EQ(done.size(), 50U);
  std::atomic<int> begun = 0;
  const auto failed = run_jobs(1000, 2, [&](std::size_t i) {
    ++begun;
    return [i]() -> Result<void> {
      if (i == 3) return fail(Fault::usage, "the fourth");
      return {};
    };
  });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "the fourth");
  EXPECT_LT(begun, 1000);
}

}  // namespace
}  // namespace kaz::studies
