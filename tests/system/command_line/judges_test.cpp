// `kaz evaluate` judges by truth: liars fail at every task, and those that do it succeed.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/behavior/behavior.h"
#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kLiar = std::string(KAZ_PLUGINS) + "/liar.so";

Finished evaluate(const std::string& behavior, const std::vector<std::string>& more) {
  std::vector<std::string> words{"evaluate", behavior, "--episodes", "1",      "--mcu",
                                 "native",   "--eyes", "ideal",      "--seed", "5"};
  words.insert(words.end(), more.begin(), more.end());
  return run(kaz(words));
}

class Liars : public ::testing::TestWithParam<std::string> {};

TEST_P(Liars, FailByTruth) {
  const std::string& task = GetParam();
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const Finished end = evaluate(kLiar, {"--judge", task, "--set", "claims=" + task, "--out", out});
  EXPECT_EQ(end.exit_code, 1) << end.out << end.err;
  const json episode = parse_json(read_file(out + "/episodes/000000.json"));
  ASSERT_TRUE(episode.is_object()) << end.err;
  EXPECT_EQ(episode["claim"], true) << episode;
  EXPECT_EQ(episode["success"], false) << episode;
  EXPECT_EQ(episode["sentence"], "all is done");
  EXPECT_NE(episode["cause"], "") << episode;
  // All reports say that claim and truth differ.
  EXPECT_NE(end.out.find("the behavior reported its success or failure correctly in 0 of 1 "
                         "episodes; false claims of success: 1, episodes 0"),
            std::string::npos)
      << end.out;
  const json result = parse_json(read_file(out + "/result.json"));
  EXPECT_EQ(result["claims"], json({{"judged", 1},
                                    {"agreed", 0},
                                    {"claimed_without_success", {0}},
                                    {"success_without_claim", json::array()}}));
  EXPECT_NE(read_file(out + "/report.html").find("correctly in 0 of 1"), std::string::npos);
  const std::string junit = read_file(out + "/junit.xml");
  EXPECT_NE(junit.find("name=\"claims_agreed\" value=\"0\""), std::string::npos) << junit;
  EXPECT_NE(junit.find("<failure"), std::string::npos) << junit;
  EXPECT_NE(junit.find("claims success: all is done"), std::string::npos) << junit;
}

// Those of which truth can decide.
std::vector<std::string> all_behaviors() {
  std::vector<std::string> names;
  for (const auto& one : behavior::behaviors()) {
    if (one.name != "play" && one.name != "pose") names.emplace_back(one.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, Liars, ::testing::ValuesIn(all_behaviors()), [](const auto& row) {
  std::string name = row.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

// The same judge lets pass what is done.
class Doers : public ::testing::TestWithParam<std::vector<std::string>> {};

TEST_P(Doers, SucceedByTruth) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  std::vector<std::string> more{GetParam().begin() + 1, GetParam().end()};
  more.insert(more.end(), {"--out", out});
  const Finished end = evaluate(GetParam().front(), more);
  EXPECT_EQ(end.exit_code, 0) << end.out << end.err;
  const json result = parse_json(read_file(out + "/result.json"));
  EXPECT_EQ(result["successes"], 1) << result;
  EXPECT_EQ(result["claims"]["agreed"], 1) << result;
}

INSTANTIATE_TEST_SUITE_P(
    All, Doers,
    ::testing::Values(std::vector<std::string>{"search-ball"},
                      std::vector<std::string>{"track-ball", "--set", "seconds=3"},
                      std::vector<std::string>{"stand", "--set", "posture=home"},
                      std::vector<std::string>{"get-up"},
                      std::vector<std::string>{"go-forward", "--set", "distance=0.2"},
                      std::vector<std::string>{"turn-left", "--set", "angle=20"}));

// Without --judge a plug-in's own word counts, and is compared with nothing.
TEST(Judges, OfAnUnknownTaskComparesNothing) {
  const TemporaryFolder folder;
  const Finished end = evaluate(kLiar, {"--set", "claims=catch-ball", "--out", folder / "out"});
  EXPECT_EQ(end.exit_code, 0) << end.err;
  const json result = parse_json(read_file(folder / "out/result.json"));
  EXPECT_EQ(result["successes"], 1);
  EXPECT_FALSE(result.contains("claims")) << result;
}

TEST(Judges, AreRefusedInOneSentence) {
  const TemporaryFolder folder;
  const auto refused = [&](std::vector<std::string> words, const std::string& text) {
    words.insert(words.begin(), "evaluate");
    words.insert(words.end(), {"--out", folder / "out"});
    const Finished end = run(kaz(words));
    EXPECT_EQ(end.exit_code, 2) << end.err;
    EXPECT_NE(end.err.find(text), std::string::npos) << end.err;
  };
  refused({"stand", "--judge", "catch-ball"}, "--judge is only valid with plug-ins");
  refused({kLiar, "--judge", "dance"}, "'dance' has no success criterion");
  refused({"play"}, "play has no success criterion");
  refused({"catch-ball", "--floors", "ice"}, "--floors ice: give wood");
  refused({"catch-ball", "--calibrated"}, "--sensors as-built: give both");
  refused({"navigate", "--props", "3", "10"}, "use --obstacles");
  refused({"catch-ball", "--props", "3.5", "4"}, "whole");
  EXPECT_FALSE(fs::exists(folder / "out"));
}

// Processors that nothing used in the last half second.
double free_processors() {
  const auto times = [] {
    std::ifstream file("/proc/stat");
    std::string cpu;
    double sum = 0, idle = 0;
    file >> cpu;
    for (int field = 0; field < 8; ++field) {
      double value = 0;
      file >> value;
      sum += value;
      if (field == 3 || field == 4) idle += value;
    }
    return std::pair{sum, idle};
  };
  const auto before = times();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto after = times();
  const double sum = after.first - before.first;
  return sum > 0 ? (after.second - before.second) / sum * std::thread::hardware_concurrency() : 0;
}

// Minutes of real time on two processors: with KAZ_LONG=1.
TEST(RealTime, NineOfTenAreCaught) {
  if (std::getenv("KAZ_LONG") == nullptr)
    GTEST_SKIP() << "it takes 8 minutes: set KAZ_LONG=1 to catch ten balls in real time";
  if (const double free = free_processors(); free < 1.8)
    GTEST_SKIP() << "real time needs two free processors, and " << free
                 << " are free here: end other programs and run it again";
  const TemporaryFolder folder;
  const Finished end = run(kaz({"evaluate", "catch-ball", "--realtime", "--episodes", "10",
                                "--seed", "83", "--out", folder / "live"}),
                           std::chrono::seconds(1200));
  const json result = parse_json(read_file(folder / "live/result.json"));
  ASSERT_TRUE(result.is_object()) << end.err;
  const auto lost = result["environment"].size();
  if (lost > 0)
    GTEST_SKIP() << lost << " of 10 episodes were lost to machine errors, so nothing is decided: "
                 << result["environment"][0]["sentence"] << "; end other programs and run it again";
  EXPECT_GE(result["successes"].get<int>(), 9) << end.out << end.err;
}

}  // namespace
}  // namespace kaz::test
