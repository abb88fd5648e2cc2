// Campaigns: the draw of an episode, its file, and the summary of many.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "shared/base/files.hpp"
#include "tools/eval/campaign.h"
#include "tools/eval/episode_file.h"
#include "tools/eval/parts.h"
#include "tools/eval/scenario.h"
#include "tools/eval/summary.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

Json episode(std::uint64_t number, bool success, double seconds, const std::string& cause = "") {
  return {{"episode", number},
          {"scenario", {{"seed", 1000 + number}}},
          {"success", success},
          {"claim", success || cause == "missed"},
          {"cause", cause},
          {"sentence", "it says \"so\""},
          {"seconds", seconds},
          {"rtf", 2.0},
          {"measurements", {{"error_m", 0.01 * static_cast<double>(number)}}},
          {"truth", {{"fell", cause == "fell"}}}};
}

TEST(Campaign, WritesTheOptionsOfTheRobotInAFixedOrder) {
  const std::string text = campaign_json({}).dump();
  EXPECT_TRUE(text.starts_with(
      R"({"behavior":"","settings":{},"realtime":false,"seed":1,"mcu":"h8","image":"",)"
      R"("sensors":"nominal","imu":false,"eyes":"ideal","eye_width":0,"renderer":"raster",)"
      R"("dynamics":"reduced","physics_step_ms":1.0,"friction":[)"))
      << text;
}

TEST(Scenario, OfASeedIsTheSameEachTimeAndWithinItsBounds) {
  const Variation variation;
  for (std::uint64_t number = 0; number < 50; ++number) {
    const Scenario s = Scenario::draw(variation, 7, number);
    EXPECT_EQ(scenario_json(s), scenario_json(Scenario::draw(variation, 7, number)));
    EXPECT_GE(s.friction, 0.6);
    EXPECT_LE(s.friction, 0.8);
    EXPECT_GE(s.supply_volts, 9.5);
    EXPECT_LE(s.supply_volts, 10.5);
    EXPECT_GE(std::hypot(s.ball_x_m, s.ball_y_m), 0.3 - 1e-9);
    EXPECT_LE(std::hypot(s.ball_x_m, s.ball_y_m), 0.8 + 1e-9);
    EXPECT_TRUE(s.ball_color == "red" || s.ball_color == "green") << s.ball_color;
  }
}

TEST(Scenario, DiffersByEpisodeAndBySeed) {
  const Variation variation;
  const Scenario one = Scenario::draw(variation, 1, 0);
  EXPECT_NE(scenario_json(one), scenario_json(Scenario::draw(variation, 1, 1)));
  EXPECT_NE(scenario_json(one), scenario_json(Scenario::draw(variation, 2, 0)));
}

TEST(Scenario, PushesAsItWasDrawn) {
  Variation variation;
  EXPECT_TRUE(Scenario::draw(variation, 1, 0).pushes.empty());
  variation.pushes = {.impulse_ns = 0.4, .from_s = 8, .every_s = 2, .to = PushTo::sides};
  const Scenario s = Scenario::draw(variation, 1, 0);
  ASSERT_GT(s.pushes.size(), 100u);
  int left = 0;
  for (std::size_t i = 0; i < s.pushes.size(); ++i) {
    EXPECT_DOUBLE_EQ(s.pushes[i].at_s, 8 + 2.0 * static_cast<double>(i));
    EXPECT_NEAR(std::abs(s.pushes[i].impulse.y()), 0.4, 1e-12);
    EXPECT_NEAR(s.pushes[i].impulse.x(), 0, 1e-12);
    left += s.pushes[i].impulse.y() > 0;
  }
  EXPECT_NEAR(left, s.pushes.size() / 2.0, s.pushes.size() / 6.0) << "either side as often";
  EXPECT_EQ(Scenario::draw(variation, 1, 0).pushes[5].impulse, s.pushes[5].impulse);
  variation.pushes.to = PushTo::back;
  EXPECT_NEAR(Scenario::draw(variation, 1, 0).pushes[0].impulse.x(), -0.4, 1e-12);
  const auto world = world_text(s);
  ASSERT_TRUE(world);
  EXPECT_NE(world->find("<kaz:push time=\"8\" link=\"trunk\""), std::string::npos);
  EXPECT_NE(world->find("first_step=\"l_ankle_pitch r_ankle_pitch\""), std::string::npos);
  variation.pushes.from_first_step = false;
  EXPECT_EQ(world_text(Scenario::draw(variation, 1, 0)).value().find("first_step"),
            std::string::npos);
}

TEST(BallColor, IsFoundByNameAndNamesTheOthers) {
  EXPECT_STREQ(ball_color("green").value().name, "green");
  const auto none = ball_color("pink");
  ASSERT_FALSE(none);
  for (const BallColor& color : ball_colors())
    EXPECT_NE(none.error().message.find(color.name), std::string::npos);
}

TEST(EpisodeFile, IsReadBackAsItWasWritten) {
  const Json written = episode(3, true, 12.5);
  const auto read = parse_episode(written.dump(), "3.json");
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, written);
}

TEST(EpisodeFile, NamesFileAndFieldThatIsWrong) {
  const Json whole = episode(1, true, 1);
  for (const auto& field : whole.items()) {
    for (const bool missing : {true, false}) {
      // An episode that did not begin has no times.
      if (missing && (field.key() == "seconds" || field.key() == "rtf" || field.key() == "claim"))
        continue;
      Json damaged = episode(1, true, 1);
      if (missing) {
        damaged.erase(field.key());
      } else {
        damaged[field.key()] = nullptr;
      }
      const auto read = parse_episode(damaged.dump(), "1.json");
      ASSERT_FALSE(read) << field.key();
      EXPECT_NE(read.error().message.find("1.json"), std::string::npos);
      EXPECT_NE(read.error().message.find("`" + field.key() + "`"), std::string::npos);
    }
  }
  EXPECT_FALSE(parse_episode("{\"episode\":", "1.json"));
  const auto twice = parse_episode(R"({"episode": 1, "episode": 2})", "1.json");
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().message,
            "1.json: is damaged (the key \"episode\" occurs twice in one object; remove one); "
            "remove the file and run the campaign again");
  EXPECT_FALSE(parse_campaign("{}", "campaign.json"));
}

// Part `shard` of 2 of an evaluation of 6 that holds these episodes; `more`: of its result.json.
Part part(std::uint64_t shard, const std::vector<std::uint64_t>& numbers,
          const Json& more = Json::object()) {
  Episodes episodes;
  for (const std::uint64_t n : numbers) episodes[n] = episode(n, true, 1);
  Json result{{"planned", {{"episodes", 6}, {"shard", shard}, {"shards", 2}}}};
  result.update(more);
  EXPECT_TRUE(parse_result(result.dump(), "result.json"));
  return part_of("part" + std::to_string(shard), episodes, result);
}

bool mentions(const Shortage& shortage, const std::string& words) {
  return shortage.sentence.find(words) != std::string::npos;
}

using Numbers = std::vector<std::uint64_t>;

TEST(Shortage, IsNoneOfAWhole) {
  const Shortage none = find_shortage({part(1, {0, 2, 4}), part(2, {1, 3, 5})});
  EXPECT_EQ(none.sentence, "");
  EXPECT_FALSE(none.extent.interrupted);
  EXPECT_EQ(none.extent.planned.episodes, 6u);
  // An interrupted part whose episodes another folder holds is none either.
  const Json interrupted{{"interrupted", true}, {"signal", "SIGINT"}};
  EXPECT_EQ(
      find_shortage({part(1, {0, 2, 4}), part(2, {1}, interrupted), part(2, {3, 5})}).sentence, "");
}

TEST(Shortage, NamesAPartThatIsNotThereUpToItsLastEpisode) {
  const Shortage found = find_shortage({part(1, {0, 2, 4})});
  EXPECT_EQ(found.extent.missing, (Numbers{1, 3, 5}));
  EXPECT_TRUE(found.extent.interrupted);
  EXPECT_EQ(found.extent.signal, "");
  EXPECT_TRUE(mentions(found, "3 of 6 episodes are missing")) << found.sentence;
  EXPECT_TRUE(mentions(found, "no folder contains part 2/2 (episodes 1, 3, 5)")) << found.sentence;
  EXPECT_TRUE(mentions(found, "--shard 2/2")) << found.sentence;
}

TEST(Shortage, NamesAPartThatWasInterrupted) {
  const Json interrupted{{"interrupted", true}, {"signal", "SIGTERM"}};
  const Shortage found = find_shortage({part(1, {0, 2, 4}), part(2, {1}, interrupted)});
  EXPECT_EQ(found.extent.missing, (Numbers{3, 5}));
  EXPECT_EQ(found.extent.signal, "SIGTERM");
  EXPECT_TRUE(mentions(
      found, "'part2' was interrupted by SIGTERM and lacks episodes 3, 5: run the command"))
      << found.sentence;
  EXPECT_FALSE(mentions(found, "no folder contains")) << found.sentence;
}

TEST(Shortage, NamesAPartThatWasKilled) {
  Part killed = part_of("part2", {{1, episode(1, true, 1)}}, nullptr);
  const Shortage found = find_shortage({part(1, {0, 2, 4}), killed});
  EXPECT_EQ(found.extent.missing, (Numbers{3, 5}));
  EXPECT_TRUE(mentions(found, "'part2' has no result.json")) << found.sentence;
  EXPECT_FALSE(mentions(found, "no folder contains")) << found.sentence;
}

TEST(Shortage, OfAnEarlierVersionsPartIsItsInterruptionAndItsGaps) {
  const Episodes episodes{{0, episode(0, true, 1)}, {2, episode(2, true, 1)}};
  const Shortage gap = find_shortage({part_of("old", episodes, Json::object())});
  EXPECT_TRUE(mentions(gap, "no folder contains episode 1")) << gap.sentence;
  const Episodes one{{0, episode(0, true, 1)}};
  const Shortage unknown =
      find_shortage({part_of("old", one, {{"interrupted", true}, {"signal", "SIGINT"}})});
  EXPECT_TRUE(unknown.extent.interrupted);
  EXPECT_TRUE(mentions(unknown, "'old' was interrupted by SIGINT")) << unknown.sentence;
}

// Neither number is that of the whole, and which episodes are missing depends on it.
TEST(Shortage, PartsOfDifferentEpisodesAreRefused) {
  EXPECT_TRUE(check_one_plan({part(1, {0, 2, 4}), part(2, {1, 3, 5})}));
  Part longer = part(2, {1, 3, 5, 7});
  longer.planned->episodes = 8;
  const auto refused = check_one_plan({longer, part(1, {0, 2, 4})});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::usage);
  EXPECT_EQ(refused.error().message,
            "'part1' was made with --episodes 6 and 'part2' with --episodes 8: parts may only "
            "differ in --shard; run the command of 'part1' again with --episodes 8; this command "
            "runs only missing episodes");
  // A part that was killed states nothing, and one of an earlier version.
  EXPECT_TRUE(check_one_plan({longer, part_of("old", {{0, episode(0, true, 1)}}, nullptr)}));
}

TEST(Shortage, KeepsWhatTheMachineLost) {
  const Json environment = Json::parse(R"({"environment":[{"episode":3,"sentence":"disk full"}]})");
  const Shortage found = find_shortage({part(1, {0, 2, 4}), part(2, {1, 5}, environment)});
  EXPECT_EQ(found.lost, (LostEpisodes{{3, "disk full"}}));
  EXPECT_TRUE(found.extent.missing.empty());
  EXPECT_FALSE(found.extent.interrupted);
  EXPECT_TRUE(mentions(found, "episode 3 lost to machine errors")) << found.sentence;
}

TEST(ResultFile, IsRefusedWhereItsPlanIsNone) {
  const auto planned = [](const Json& plan) {
    return parse_result(Json{{"planned", plan}}.dump(), "result.json").has_value();
  };
  EXPECT_TRUE(planned({{"episodes", 6}, {"shard", 2}, {"shards", 2}}));
  EXPECT_FALSE(planned({{"episodes", 6}, {"shard", 3}, {"shards", 2}}));
  EXPECT_FALSE(planned({{"episodes", 6}, {"shard", 0}, {"shards", 0}}));
  EXPECT_FALSE(planned({{"episodes", 18446744073709551615u}, {"shard", 1}, {"shards", 1}}));
  EXPECT_FALSE(planned("6"));
  EXPECT_FALSE(parse_result(R"({"environment":[3]})", "result.json"));
  EXPECT_FALSE(parse_result(R"({"interrupted":"yes"})", "result.json"));
}

class Summary : public testing::Test {
 protected:
  Summary()
      : path_(make_temporary_folder("kaz-summary-").value()),
        folder_(
            OutputFolder::begin(
                path_, {"evaluate", {"result.json", "report.html", "junit.xml", "episodes.csv"}})
                .value()) {}
  ~Summary() override {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  std::string read(const std::string& name) const {
    std::ifstream file(path_ + "/" + name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::string path_;
  OutputFolder folder_;
};

TEST_F(Summary, CountsSuccessesFallsAndCauses) {
  const Episodes episodes{{0, episode(0, true, 10)},
                          {1, episode(1, true, 20)},
                          {2, episode(2, false, 30, "fell")},
                          {3, episode(3, false, 40, "missed")}};
  const auto any = summarize({{"behavior", "track-ball"}}, episodes, {}, folder_, true);
  ASSERT_TRUE(any);
  EXPECT_TRUE(*any);
  const Json result = Json::parse(read("result.json"));
  EXPECT_EQ(result["episodes"], 4);
  EXPECT_EQ(result["successes"], 2);
  EXPECT_EQ(result["success_rate"], 0.5);
  EXPECT_EQ(result["falls"], 1);
  EXPECT_EQ(result["failures"]["fell"], Json::array({2}));
  EXPECT_EQ(result["failures"]["missed"], Json::array({3}));
  EXPECT_EQ(result["claims"]["agreed"], 3);
  EXPECT_EQ(result["claims"]["claimed_without_success"], Json::array({3}));
  EXPECT_LT(result["interval"][0], 0.5);
  EXPECT_GT(result["interval"][1], 0.5);
  // Measurements of the behavior are those of successful episodes.
  EXPECT_EQ(result["measurements"]["error_m"]["p95"], 0.01);
}

// Whatever else an episode of another version has there is not counted.
TEST_F(Summary, AddsUpTheStepsThatDidNotConverge) {
  Episodes episodes{{1, episode(1, true, 1)}, {2, episode(2, true, 1)}, {3, episode(3, true, 1)}};
  episodes[1]["truth"]["unconverged_steps"] = 2;
  episodes[2]["truth"]["unconverged_steps"] = 3;
  episodes[3]["truth"]["unconverged_steps"] = "many";
  ASSERT_TRUE(summarize({{"behavior", "stand"}}, episodes, {}, folder_, false));
  EXPECT_EQ(Json::parse(read("result.json"))["unconverged_steps"], 5);
}

// A crashed episode has no times; a part without episodes has no rate.
TEST_F(Summary, HasNothingThatWasNotMeasured) {
  Json crashed = episode(6, false, 0, "crashed");
  crashed.erase("seconds");
  crashed.erase("rtf");
  ASSERT_TRUE(parse_episode(crashed.dump(), "6.json"));
  ASSERT_TRUE(summarize({{"behavior", "stand"}}, {{6, crashed}}, {}, folder_, false));
  const Json one = Json::parse(read("result.json"));
  EXPECT_EQ(one["success_rate"], 0.0) << "measured: none of one";
  EXPECT_FALSE(one.contains("seconds"));
  EXPECT_FALSE(one.contains("rtf_median"));
  EXPECT_FALSE(one.contains("unconverged_steps"));
  EXPECT_TRUE(one["provenance"].contains("date"));
  EXPECT_NE(read("episodes.csv").find("6,1006,0,0,crashed,,,"), std::string::npos)
      << read("episodes.csv");
  ASSERT_TRUE(summarize({{"behavior", "stand"}}, {}, {}, folder_, false));
  const Json none = Json::parse(read("result.json"));
  EXPECT_FALSE(none.contains("success_rate"));
  EXPECT_FALSE(none.contains("interval"));
  EXPECT_EQ(none["episodes"], 0);
}

// What the machine did not let end is neither a success nor a failure.
TEST_F(Summary, NamesLostEpisodesBesideTheRate) {
  const Episodes episodes{{0, episode(0, true, 10)}, {2, episode(2, false, 30, "fell")}};
  const LostEpisodes lost{{1, "the process of the episode was ended by signal 9"},
                          {3, "disk full"}};
  ASSERT_TRUE(summarize({{"behavior", "track-ball"}}, episodes, lost, folder_, true));
  const Json result = Json::parse(read("result.json"));
  EXPECT_EQ(result["episodes"], 2);
  EXPECT_EQ(result["success_rate"], 0.5);
  ASSERT_EQ(result["environment"].size(), 2u);
  EXPECT_EQ(result["environment"][0]["episode"], 1);
  EXPECT_EQ(result["environment"][1]["sentence"], "disk full");
  EXPECT_EQ(result["failures"].size(), 1u);
}

// By kind of world, density and floor; a behavior that does not walk in such worlds has no such tables.
TEST_F(Summary, BreaksWalksDownByWorldDensityAndFloor) {
  Episodes episodes{{0, episode(0, true, 10)},
                    {1, episode(1, false, 20, "touched")},
                    {2, episode(2, false, 30, "no path")}};
  const auto world = [&](std::uint64_t number, const char* kind, double density) {
    episodes[number]["scenario"].update(Json{{"world", kind},
                                             {"density", density},
                                             {"floor", "wood"},
                                             {"goal_m", {1.0, 0.0}},
                                             {"least_s", 20.0}});
  };
  world(0, "slalom", 0.1);
  world(1, "moving-box", 0.5);
  world(2, "slalom", 0.9);
  episodes[0]["measurements"]["moving_s"] = 30.0;
  episodes[0]["truth"].update(Json{{"forward_m", 1.03}, {"aside_m", 0.04}});
  episodes[1]["truth"].update(
      Json{{"moving", {{"in_the_way", true}, {"noticed_s", 1.5}}}, {"touched", Json::object()}});
  ASSERT_TRUE(summarize({{"behavior", "navigate"}}, episodes, {}, folder_, false));
  const Json by = Json::parse(read("result.json"))["by"];
  EXPECT_EQ(by["world"]["slalom"]["episodes"], 2);
  EXPECT_EQ(by["world"]["slalom"]["successes"], 1);
  EXPECT_EQ(by["world"]["slalom"]["failures"], Json({{"no path", {2}}}));
  EXPECT_EQ(by["world"]["slalom"]["over_least"]["median"], 1.5);
  EXPECT_NEAR(by["world"]["slalom"]["off_goal_m"]["max"].get<double>(), 0.05, 1e-9);
  EXPECT_EQ(by["world"]["moving-box"]["successes"], 0);
  EXPECT_EQ(by["density"]["sparse"]["successes"], 1);
  EXPECT_EQ(by["density"]["medium"]["failures"], Json({{"touched", {1}}}));
  EXPECT_EQ(by["density"]["dense"]["episodes"], 1);
  EXPECT_EQ(by["floor"]["wood"]["episodes"], 3);
  EXPECT_EQ(by["moving"], Json({{"in_the_way", 1}, {"noticed", 1}, {"touched", 1}}));
  const std::string page = read("report.html");
  for (const char* words : {"<td>slalom</td><td>1 of 2</td>", "<td>1 no path</td>",
                            "href=\"failures/000001\"", "noticed the box in 1"})
    EXPECT_NE(page.find(words), std::string::npos) << words;

  ASSERT_TRUE(summarize({{"behavior", "stand"}}, {{0, episode(0, true, 10)}}, {}, folder_, true));
  EXPECT_FALSE(Json::parse(read("result.json")).contains("by"));
}

TEST_F(Summary, StatesWhatWasPlannedAndWhatIsMissing) {
  const Episodes episodes{{0, episode(0, true, 10)}};
  ASSERT_TRUE(summarize({{"behavior", "stand"}}, episodes, {}, folder_, true,
                        {{3, 1, 1}, {1, 2}, true, "SIGINT"}));
  const Json part = Json::parse(read("result.json"));
  EXPECT_EQ(part["planned"]["episodes"], 3);
  EXPECT_EQ(part["missing"], Json::array({1, 2}));
  EXPECT_EQ(part["interrupted"], true);
  EXPECT_EQ(part["signal"], "SIGINT");
  EXPECT_TRUE(parse_result(part.dump(), "result.json"));
  ASSERT_TRUE(summarize({{"behavior", "stand"}}, episodes, {}, folder_, true, {{1, 1, 1}}));
  const Json whole = Json::parse(read("result.json"));
  for (const char* key : {"missing", "interrupted", "signal"})
    EXPECT_FALSE(whole.contains(key)) << key;
}

TEST_F(Summary, WritesARowForEachEpisode) {
  const Episodes episodes{{5, episode(5, false, 30, "missed")}};
  const auto any = summarize({{"behavior", "track-ball"}}, episodes, {}, folder_, true);
  ASSERT_TRUE(any);
  EXPECT_FALSE(*any);
  EXPECT_EQ(read("episodes.csv"),
            "episode,seed,success,claim,cause,seconds,rtf,sentence\n"
            "5,1005,0,1,missed,30.0,2.0,\"it says 'so'\"\n");
}

}  // namespace
}  // namespace kaz::tools
