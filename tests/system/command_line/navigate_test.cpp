// `kaz run navigate`: a goal beyond boxes, one that cannot be reached, and goals that are none; and whether
// it reached one in truth.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Finished navigate(const std::string& goal, std::vector<std::string> more) {
  std::vector<std::string> all{"run",    "navigate", "--goal", goal,    "--world", "boxes",
                               "--eyes", "real",     "--imu",  "--mcu", "native"};
  all.insert(all.end(), more.begin(), more.end());
  return run(kaz(all));
}

// The way straight ahead is free for 0.4 m; then a box stands to the left.
TEST(Navigate, WalksPastABoxAndLeavesTheMap) {
  const TemporaryFolder folder;
  const Finished finished = navigate("0.6,-0.15", {"--out", folder / "there", "--json"});
  ASSERT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  const json result = parse_json(finished.out);
  EXPECT_LE(result["missed_m"].get<double>(), 0.03);
  EXPECT_GE(result["walked_m"].get<double>(), 0.4);
  EXPECT_GE(result["corrections"].get<int>(), 1) << "the floor's pattern was not found again";
  EXPECT_TRUE(fs::exists(folder / "there/map.png"));
  EXPECT_NE(std::ranges::find(result["pictures"], "map.png"), result["pictures"].end());
}

TEST(Navigate, ReachesTheGoalThatItHasWithoutOne) {
  const TemporaryFolder folder;
  const Finished finished =
      run(kaz({"run", "navigate", "--mcu", "native", "--out", folder / "there", "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  const json result = parse_json(finished.out);
  EXPECT_NEAR(result["goal_x_m"].get<double>(), 1.2, 1e-9);
  EXPECT_NEAR(result["goal_y_m"].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(
      std::hypot(result["place_x_m"].get<double>() - 1.2, result["place_y_m"].get<double>() - 0.1),
      result["missed_m"].get<double>(), 1e-5);
}

// A floor of one colour has no depth.
TEST(Navigate, SaysThatItHardlySeesTheFloor) {
  const TemporaryFolder folder;
  std::string world = read_file(KAZ_TREE "/sim/worlds/boxes.sdf");
  const auto texture = world.find("<kaz:texture");
  ASSERT_NE(texture, std::string::npos);
  world.erase(texture, world.find("/>", texture) + 2 - texture);
  write_file(folder / "plain.sdf", world);
  const Finished finished = run(kaz({"run", "navigate", "--world", folder / "plain.sdf", "--goal",
                                     "0.5,0.12", "--eyes", "real", "--mcu", "native"}));
  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  EXPECT_NE(finished.out.find(" m2 of floor was seen: add light, or put a texture on a plain"),
            std::string::npos)
      << finished.out;
}

// The floor below the robot, which it cannot see, is no obstacle.
TEST(Navigate, WalksOnFloorAloneThatItHasSeen) {
  const Finished finished = navigate("0.45,-0.15", {"--set", "unknown=closed"});
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
}

TEST(Navigate, WalksAPathOfOmpl) {
  const TemporaryFolder folder;
  const Finished finished =
      navigate("0.6,-0.15", {"--set", "planner=ompl", "--out", folder / "there", "--json"});
  if (finished.err.find("not in this build") != std::string::npos) {  // ompl_absent_test.cpp
    EXPECT_EQ(finished.exit_code, 3);
    EXPECT_NE(finished.err.find("install libompl-dev"), std::string::npos) << finished.err;
    return;
  }
  ASSERT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  EXPECT_LE(parse_json(finished.out)["missed_m"].get<double>(), 0.03);
}

// OMPL's libraries would cost each start of every verb 10 ms, and libsdformat 20 ms.
TEST(Navigate, ModulesAreNotLoadedByOtherPlansAndVerbs) {
  std::vector<std::string> traced = kaz({"--version"});
  traced.insert(traced.begin(), {"/usr/bin/env", "LD_TRACE_LOADED_OBJECTS=1"});
  const Finished finished = run(traced);
  EXPECT_NE(finished.out.find("libstdc++"), std::string::npos) << finished.out << finished.err;
  for (const char* library : {"libompl", "libsdformat"})
    EXPECT_EQ(finished.out.find(library), std::string::npos) << finished.out;
}

TEST(Navigate, RefusesThePapersTurnsWithOmpl) {
  const Finished finished =
      navigate("0.6,-0.15", {"--set", "planner=ompl", "--set", "turns=paper"});
  EXPECT_EQ(finished.exit_code, 2) << finished.out << finished.err;
  EXPECT_NE(finished.err.find("planner=grid"), std::string::npos) << finished.err;
}

// The map shows the edge before the robot is there; beyond it the floor is half a metre below. The table is
// smaller than that of the product, so that all ways are tried sooner.
TEST(Navigate, StopsBeforeTheEdgeOfATable) {
  const TemporaryFolder folder;
  std::string world = read_file(KAZ_TREE "/sim/worlds/table.sdf");
  const auto replace = [&](const std::string& old, const std::string& now) {
    ASSERT_NE(world.find(old), std::string::npos) << old;
    for (auto at = world.find(old); at != std::string::npos; at = world.find(old, at + now.size()))
      world.replace(at, old.size(), now);
  };
  replace("<size>1.1 1.2 0.04</size>", "<size>0.8 0.7 0.04</size>");
  replace("<pose>0.25 0 -0.02 0 0 0</pose>", "<pose>0 0 -0.02 0 0 0</pose>");
  replace("<pose>0.55 0.35 0.05 0 0 0.3</pose>", "<pose>0.25 0.28 0.05 0 0 0.3</pose>");
  write_file(folder / "table.sdf", world);
  const Finished finished =
      run(kaz({"run", "navigate", "--goal", "1.3,0", "--world", folder / "table.sdf", "--eyes",
               "real", "--imu", "--mcu", "native", "--out", folder / "edge", "--json"}),
          std::chrono::seconds(280));
  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  const json result = parse_json(finished.out);
  EXPECT_EQ(result["sentence"].get<std::string>().find("no path: "), 0U) << finished.out;
  EXPECT_LT(result["place_x_m"].get<double>(), 0.4);  // the edge
}

// In the middle of a box.
TEST(Navigate, SaysWhyThereIsNoWay) {
  const Finished finished = navigate("0.5,0.12", {});
  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  EXPECT_NE(finished.out.find("no path: the goal is "), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find(" m from an obstacle at ("), std::string::npos) << finished.out;
}

TEST(Navigate, RefusesGoalsThatAreNone) {
  for (const char* goal : {"there", "1", "9,9", "1,2,3,4"}) {
    const Finished finished = navigate(goal, {});
    EXPECT_EQ(finished.exit_code, 2) << goal;
    EXPECT_NE(finished.err.find("X,Y or X,Y,HEADING or ball"), std::string::npos) << finished.err;
  }
  const Finished two = navigate("1,0", {"--set", "goal=0.5,0"});
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_NE(two.err.find("contradict each other"), std::string::npos) << two.err;
}

// An episode with obstacles, judged by where the robot truly is.
TEST(Navigate, ReachesAGoalInTruth) {
  const TemporaryFolder folder;
  const Finished finished =
      run(kaz({"evaluate", "navigate", "--episodes", "9", "--shard", "9/9", "--seed", "5", "--mcu",
               "native", "--goal-distance", "0.5", "0.6", "--out", folder / "one", "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  const json episode = parse_json(read_file(folder / "one/episodes/000008.json"));
  const json& scenario = episode["scenario"];
  EXPECT_GE(scenario["obstacles"].get<int>(), 4);
  EXPECT_GT(scenario["least_s"].get<double>(), 5);
  EXPECT_FALSE(episode["truth"].contains("touched"));
  const double off =
      std::hypot(episode["truth"]["forward_m"].get<double>() - scenario["goal_m"][0].get<double>(),
                 episode["truth"]["aside_m"].get<double>() - scenario["goal_m"][1].get<double>());
  EXPECT_LE(off, 0.05);
}

// A box comes to rest on the path that is being walked, some 40 cm ahead: the robot plans around it.
TEST(Navigate, NoticesABoxThatSlidesIntoItsWay) {
  const TemporaryFolder folder;
  const Finished finished = run(kaz({"evaluate",   "navigate", "--worlds",  "moving-box",
                                     "--episodes", "1",        "--seed",    "5",
                                     "--mcu",      "native",   "--bearing", "5",
                                     "--density",  "0",        "0",         "--goal-distance",
                                     "1.1",        "1.1",      "--out",     folder / "moving",
                                     "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  const json result = parse_json(finished.out);
  EXPECT_EQ(result["by"]["world"]["moving-box"]["successes"], 1);
  EXPECT_EQ(result["by"]["moving"], json({{"in_the_way", 1}, {"noticed", 1}, {"touched", 0}}));
  const json episode = parse_json(read_file(folder / "moving/episodes/000000.json"));
  const json& moving = episode["truth"]["moving"];
  EXPECT_GT(moving["arrived_s"].get<double>(),
            episode["scenario"]["moving"]["at_s"].get<double>() + 0.5);
  EXPECT_GT(moving["away_m"].get<double>(), 0.25);
  EXPECT_GT(moving["nearest_m"].get<double>(), 0.12);
  EXPECT_TRUE(fs::exists(folder / "moving/report.html"));
}

TEST(Navigate, RefusesWorldsThatAreNone) {
  const TemporaryFolder folder;
  const struct {
    std::vector<std::string> words;
    const char* sentence;
  } cases[] = {
      {{"navigate", "--worlds", "clutter,maze"}, "'maze' is not a kind of world: use one of these: all, "},
      {{"navigate", "--worlds", "all,dark"}, "--worlds: a value is in the list twice"},
      {{"navigate", "--density", "0.5", "1.5"}, "--density"},
      {{"navigate", "--worlds", "corridor", "--obstacles", "4"}, "--obstacles is only valid in"},
      {{"stand", "--worlds", "clutter"}, "--worlds is only valid with navigate"}};
  for (const auto& [words, sentence] : cases) {
    std::vector<std::string> all{"evaluate"};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--out", folder / "none"});
    const Finished finished = run(kaz(all));
    EXPECT_EQ(finished.exit_code, 2) << sentence;
    EXPECT_NE(finished.err.find(sentence), std::string::npos) << finished.err;
  }
}

}  // namespace
}  // namespace kaz::test
