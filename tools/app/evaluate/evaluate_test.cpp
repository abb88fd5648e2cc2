// Campaigns: the draw of an episode, its file, and the summary of many.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "shared/base/files.hpp"
#include "tools/app/evaluate/episode_file.h"
#include "tools/app/evaluate/scenario.h"
#include "tools/app/evaluate/summary.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

Json episode(std::uint64_t number, bool success, double seconds, const std::string& cause = "") {
  return {{"episode", number},
          {"scenario", {{"seed", 1000 + number}}},
          {"success", success},
          {"cause", cause},
          {"sentence", "it says \"so\""},
          {"seconds", seconds},
          {"rtf", 2.0},
          {"measurements", {{"error_m", 0.01 * static_cast<double>(number)}}},
          {"truth", {{"fell", cause == "fell"}}}};
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
      if (missing && (field.key() == "seconds" || field.key() == "rtf")) continue;
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
  EXPECT_FALSE(parse_campaign("{}", "campaign.json"));
}

class Summary : public testing::Test {
 protected:
  Summary()
      : path_(make_temporary_folder("kaz-summary-").value()),
        folder_(OutputFolder::begin(path_, {"evaluate", {"result.json", "episodes.csv"}}).value()) {
  }
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
  EXPECT_LT(result["interval"][0], 0.5);
  EXPECT_GT(result["interval"][1], 0.5);
  // Measurements of the behaviour are those of successful episodes.
  EXPECT_EQ(result["measurements"]["error_m"]["p95"], 0.01);
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
  EXPECT_TRUE(one["provenance"].contains("date"));
  EXPECT_NE(read("episodes.csv").find("6,1006,0,crashed,,,"), std::string::npos)
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
  const LostEpisodes lost{{1, "its process was ended by signal 9"}, {3, "disk full"}};
  ASSERT_TRUE(summarize({{"behavior", "track-ball"}}, episodes, lost, folder_, true));
  const Json result = Json::parse(read("result.json"));
  EXPECT_EQ(result["episodes"], 2);
  EXPECT_EQ(result["success_rate"], 0.5);
  ASSERT_EQ(result["environment"].size(), 2u);
  EXPECT_EQ(result["environment"][0]["episode"], 1);
  EXPECT_EQ(result["environment"][1]["sentence"], "disk full");
  EXPECT_EQ(result["failures"].size(), 1u);
}

TEST_F(Summary, WritesARowForEachEpisode) {
  const Episodes episodes{{5, episode(5, false, 30, "missed")}};
  const auto any = summarize({{"behavior", "track-ball"}}, episodes, {}, folder_, true);
  ASSERT_TRUE(any);
  EXPECT_FALSE(*any);
  EXPECT_EQ(read("episodes.csv"),
            "episode,seed,success,cause,seconds,rtf,sentence\n"
            "5,1005,0,missed,30.0,2.0,\"it says 'so'\"\n");
}

}  // namespace
}  // namespace kaz::tools
