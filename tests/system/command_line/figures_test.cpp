// `kaz figures`: each figure shows what it claims, a recording gives the same ones, and wrong options.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"
#include "tools/app/figures/frame_information/sweep.h"
#include "vision/image/picture_file.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Finished figures(std::vector<std::string> more) {
  std::vector<std::string> all{"figures", "--mcu", "native"};
  all.insert(all.end(), more.begin(), more.end());
  return run(kaz(all), std::chrono::seconds(200));
}

struct Rgb {
  int r, g, b;
};
bool is_red(Rgb c) {
  return c.r > c.g + 60 && c.r > c.b + 60;
}
bool is_blue(Rgb c) {
  return c.b > c.r + 60 && c.b > c.g;
}
bool is_grey(Rgb c) {
  return std::abs(c.r - c.g) < 3 && std::abs(c.g - c.b) < 3;
}
bool is_black(Rgb c) {
  return is_grey(c) && c.r < 80;
}
bool is_unseen(Rgb c) {
  return is_grey(c) && std::abs(c.r - 128) < 3;
}

// Of a part of a picture, in shares of its width and height: the share of the pixels that `is` holds for.
double share(const vision::Image& image, double left, double top, double right, double bottom,
             const std::function<bool(Rgb)>& is) {
  int all = 0, those = 0;
  for (int y = static_cast<int>(top * image.height); y < static_cast<int>(bottom * image.height);
       ++y) {
    for (int x = static_cast<int>(left * image.width); x < static_cast<int>(right * image.width);
         ++x) {
      const std::uint8_t* p = &image.rgb[static_cast<std::size_t>(3 * (y * image.width + x))];
      ++all;
      those += is({p[0], p[1], p[2]}) ? 1 : 0;
    }
  }
  return all == 0 ? 0 : static_cast<double>(those) / all;
}

// A quarter of a picture of 2 x 2 panels.
double quarter(const vision::Image& image, int column, int row,
               const std::function<bool(Rgb)>& is) {
  return share(image, 0.5 * column, 0.5 * row, 0.5 * (column + 1), 0.5 * (row + 1), is);
}

vision::Image picture(const std::string& path) {
  auto image = vision::read_picture(path);
  EXPECT_TRUE(image) << image.error().message;
  return image.value_or(vision::Image{});
}

TEST(Figures, ASceneHasBallDepthAndFlowAndIsDrawnAgainOfItsRecording) {
  const TemporaryFolder folder;
  const Finished drawn = figures({"--only", "3", "--out", folder / "out", "--json"});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.out << drawn.err;
  EXPECT_EQ(drawn.err, "");
  const json result = parse_json(drawn.out);
  EXPECT_EQ(result, parse_json(read_file(folder / "out/result.json")));
  const json& scene = result["figures"]["3"];
  EXPECT_TRUE(scene["ball"]["found"].get<bool>());
  EXPECT_GT(scene["ball_moved_px"].get<double>(), 1);
  EXPECT_GT(scene["depth"]["known"].get<double>(), 0.3);
  EXPECT_GT(scene["flow"]["known"].get<double>(), 0.3);
  const vision::Image image = picture(folder / "out/figure3.png");
  ASSERT_GT(image.width, 800);
  // Extracted: as many pixels as the ball has, by its radius, and a quarter more or less.
  const double radius = scene["ball"]["radius_px"].get<double>(), disc = M_PI * radius * radius;
  EXPECT_NEAR(scene["color"]["pixels"].get<double>(), disc, 0.3 * disc);
  EXPECT_GT(quarter(image, 1, 0, is_red), 0.0005);
  EXPECT_LT(quarter(image, 1, 0, is_red), 0.05);
  EXPECT_GT(quarter(image, 0, 1, [](Rgb c) { return !is_grey(c); }), 0.2) << "depth in colours";
  EXPECT_GT(quarter(image, 1, 1, is_blue), 0.01) << "arrows of flow";
  EXPECT_FALSE(fs::exists(folder / "out/figure5.png"));
  EXPECT_NE(read_file(folder / "out/figures.html").find("figure3.png"), std::string::npos);

  const Finished again =
      run(kaz({"figures", "--recording", folder / "out/track-ball/recording.mcap", "--only", "3",
               "--out", folder / "again"}));
  ASSERT_EQ(again.exit_code, 0) << again.out << again.err;
  EXPECT_TRUE(read_file(folder / "again/figure3.png") == read_file(folder / "out/figure3.png"));
  EXPECT_FALSE(fs::exists(folder / "again/track-ball"));

  const Finished other =
      run(kaz({"figures", "--recording", folder / "out/track-ball/recording.mcap", "--only", "6",
               "--out", folder / "other"}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("a run of track-ball does not contain figure 6"), std::string::npos)
      << other.err;
  EXPECT_FALSE(fs::exists(folder / "other"));
}

// A short walk, straight ahead at first.
TEST(Figures, AMapAndAPathAreThoseOfTheWalk) {
  const TemporaryFolder folder;
  const Finished drawn =
      figures({"--only", "5,6", "--goal", "0.4,-0.15", "--out", folder / "out", "--json"});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.out << drawn.err;
  const json result = parse_json(drawn.out);
  // The ball of sim/worlds/boxes.sdf.
  EXPECT_NEAR(result["figures"]["5"]["ball_m"][0].get<double>(), 1.4, 0.03);
  EXPECT_NEAR(result["figures"]["5"]["ball_m"][1].get<double>(), 0.1, 0.01);
  const json& map = result["figures"]["6"];
  ASSERT_EQ(map["frames"].size(), 5u);
  double floor = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    const json& frame = map["frames"][i];
    EXPECT_NEAR(frame["pan_deg"].get<double>(), 60 - 30.0 * static_cast<double>(i), 4);
    EXPECT_TRUE(frame["floor_found"].get<bool>());
    EXPECT_GT(frame["floor_m2"].get<double>(), 0.1);
    floor = std::max(floor, frame["floor_m2"].get<double>());
  }
  EXPECT_GT(map["map"]["floor_m2"].get<double>(), 1.5 * floor) << "merged from several";
  EXPECT_GT(map["map"]["obstacle_m2"].get<double>(), 0.01);
  EXPECT_NEAR(map["goal_m"][0].get<double>(), 0.4, 1e-3);
  EXPECT_NEAR(map["path_m"].back()[0].get<double>(), 0.4, 0.01);
  EXPECT_GE(map["path_length_m"].get<double>(), std::hypot(0.4, 0.15) - 0.01);
  const json& walk = result["runs"][0];
  EXPECT_EQ(walk["outcome"], "done");
  EXPECT_LT(map["planned_s"].get<double>(), walk["duration_s"].get<double>());
  EXPECT_EQ(parse_json(read_file(folder / "out/navigate/result.json"))["sentence"],
            walk["sentence"]);

  const vision::Image image = picture(folder / "out/figure6.png");
  ASSERT_GT(image.height, 700);
  EXPECT_GT(share(image, 0, 0, 1, 0.2, is_red), 0.1) << "planes";
  for (const double top : {0.25, 0.55}) {
    EXPECT_GT(share(image, 0, top, 1, top + 0.2, is_unseen), 0.02) << top;
    EXPECT_GT(share(image, 0, top, 1, top + 0.2, is_black), 0.001) << top;
  }
  EXPECT_GT(share(image, 0.5, 0.5, 1, 1, is_red), 0.001) << "the path";
  EXPECT_LT(share(image, 0, 0.5, 0.49, 1, is_red), 1e-6) << "no path yet";
  EXPECT_GT(picture(folder / "out/figure5.png").width, 800);
}

TEST(Figures, FrameInformationHasTheNumbersOfItsSweep) {
  const TemporaryFolder folder;
  const Finished drawn = figures({"--only", "7", "--seed", "3", "--out", folder / "out", "--json"});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.out << drawn.err;
  const json result = parse_json(drawn.out)["figures"]["7"];
  const auto sweep = figure7::sweep({.world = KAZ_YARD,
                                     .robot_folder = KAZ_ROBOT,
                                     .image_path = {},
                                     .mcu = sim::McuKind::native,
                                     .seed = 3});
  ASSERT_TRUE(sweep) << sweep.error().message;
  EXPECT_EQ(result["pictures"].get<int>(), sweep->pictures);
  const auto area = [&](int cells) { return cells * 1e-4; };
  for (const auto& [name, map, floor] :
       {std::tuple{"with_frame_information", &sweep->with, sweep->swept.back().floor_with},
        {"without", &sweep->without, sweep->swept.back().floor_without}}) {
    const auto score = figure7::score(figure7::edge_errors(*map, sweep->edges, 0.2, 0.8));
    const json& errors = result["edge_errors"][name];
    EXPECT_EQ(errors["places"].get<int>(), score.points);
    EXPECT_NEAR(errors["median_mm"].get<double>(), 1e3 * score.median_m, 0.01);
    EXPECT_NEAR(errors["p95_mm"].get<double>(), 1e3 * score.p95_m, 0.01);
    EXPECT_NEAR(errors["floor_m2"].get<double>(), area(floor), 1e-4);
  }
  EXPECT_GT(picture(folder / "out/figure7.png").height, 600);
}

TEST(Figures, WrongOptionsAreRefusedBeforeAnythingRuns) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::vector<std::string>& options, const std::string& why) {
    const Finished finished = figures(options);
    EXPECT_EQ(finished.exit_code, 2) << finished.err;
    EXPECT_NE(finished.err.find(why), std::string::npos) << finished.err;
    EXPECT_EQ(std::ranges::count(finished.err, '\n'), 1) << finished.err;
  };
  const std::string out = folder / "out";
  refused({"--only", "4", "--out", out}, "3,5,6,7,8");
  refused({"--only", "3,x", "--out", out}, "3,5,6,7,8");
  refused({"--out", "/proc/x"}, "'/proc/x'");
  refused({"--world", "moon", "--out", out}, "moon");
  refused({"--only", "7", "--yard", "empty", "--out", out}, "has no stationary box");
  refused({"--only", "6", "--goal", "there", "--out", out}, "X,Y or X,Y,HEADING or ball");
  refused({"--recording", folder / "none.mcap", "--out", out}, "--mcu");
  const Finished none = run(kaz({"figures", "--recording", folder / "none.mcap", "--out", out}));
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("none.mcap"), std::string::npos) << none.err;
  EXPECT_FALSE(fs::exists(out));
}

// Where there is no ball: what there is to draw is drawn, and the rest said.
TEST(Figures, OfARunThatFailsWhatItShowsIsDrawn) {
  const TemporaryFolder folder;
  const Finished ran = run(kaz({"run", "catch-ball", "--mcu", "native", "--world", "empty", "--set",
                                "seconds=10", "--out", folder / "run"}));
  ASSERT_EQ(ran.exit_code, 1) << ran.out << ran.err;
  const Finished drawn =
      run(kaz({"figures", "--recording", folder / "run/recording.mcap", "--out", folder / "out"}));
  EXPECT_EQ(drawn.exit_code, 1) << drawn.out << drawn.err;
  EXPECT_NE(drawn.out.find("catch-ball did not succeed: "), std::string::npos) << drawn.out;
  EXPECT_NE(drawn.out.find("figure 3: no picture of the run has the ball"), std::string::npos)
      << drawn.out;
  const json result = parse_json(read_file(folder / "out/result.json"));
  EXPECT_TRUE(result["not_drawn"].contains("3"));
  EXPECT_TRUE(fs::exists(folder / "out/figure5.png"));
}

}  // namespace
}  // namespace kaz::test
