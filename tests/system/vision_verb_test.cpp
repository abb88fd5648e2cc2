// `kaz vision` on pictures of the virtual eyes: a colour learned in one is found, and bad pictures named.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/process.h"
#include "vision/picture_file.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Pictures of both eyes with lenses and noise, 640 wide, and the eyes' calibration.
void draw_eyes(const TemporaryFolder& folder) {
  const Finished eyes =
      run(kaz({"eyes", "--world", "ball", "--eye-width", "640", "--out", folder / "eyes"}));
  ASSERT_EQ(eyes.exit_code, 0) << eyes.err;
  const Finished calibration = run(kaz({"sim", "--eyes", "real", "--eye-width", "640", "--mcu",
                                        "native", "--write-calibration", folder / "eyes.yml"}));
  ASSERT_EQ(calibration.exit_code, 0) << calibration.err;
  fs::create_directory(folder / "left");
  fs::copy_file(folder / "eyes/left_raw.png", folder / "left/1.png");
}

// The last line holds all words.
void expect_refusal(const Finished& finished, int exit_code,
                    const std::vector<std::string>& words) {
  EXPECT_EQ(finished.exit_code, exit_code) << finished.err;
  for (const auto& word : words)
    EXPECT_NE(finished.err.find(word), std::string::npos) << word << ": " << finished.err;
  EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
}

TEST(VisionVerb, FindsTheBallWhoseColourItLearned) {
  const TemporaryFolder folder;
  draw_eyes(folder);
  const Finished learned = run(kaz({"vision", "learn-color", "--in", folder / "left/1.png",
                                    "--region", "415,330,24,24", "--out", folder / "green.json"}));
  ASSERT_EQ(learned.exit_code, 0) << learned.err;
  const json color = json::parse(read_file(folder / "green.json"));
  EXPECT_GT(color["share_of_region"], 0.95);
  // The whole ball is 0.5 % of the picture.
  EXPECT_LT(color["share_of_rest"], 0.01);

  // Beside it: a picture that ends early, one of another size, and something else.
  const std::string whole = read_file(folder / "left/1.png");
  write_file(folder / "left/2.png", whole.substr(0, whole.size() / 2));
  write_file(folder / "left/3.ppm", "P6\n2 2\n255\n" + std::string(12, 'x'));
  write_file(folder / "left/notes.txt", "no picture");
  const Finished found = run(kaz({"vision", "run", "--in", folder / "left", "--calibration",
                                  folder / "eyes.yml", "--color", folder / "green.json", "--radius",
                                  "0.06", "--out", folder / "found", "--json"}));
  ASSERT_EQ(found.exit_code, 0) << found.err;
  EXPECT_TRUE(found.err.empty()) << found.err;
  const json result = json::parse(found.out);
  EXPECT_EQ(result, json::parse(read_file(folder / "found/result.json")));
  ASSERT_EQ(result["pictures"].size(), 3u);
  const json& ball = result["pictures"][0];
  ASSERT_TRUE(ball["found"].get<bool>());
  EXPECT_GT(ball["confidence"], 0.8);
  // sim/worlds/ball.sdf has it at 1.02, -0.26, 0.06 m with 0.06 m of radius; the URDF has the left eye
  // at 0.03, 0.02 and, standing, about 0.3 m: 1.06 m away. The eye is turned by up to 0.01 rad. 3 % of
  // distance for noise and one sample a pixel.
  EXPECT_NEAR(ball["position_m"][0].get<double>(), 0.28, 0.011 + 0.03 * 0.28);
  EXPECT_NEAR(ball["distance_m"].get<double>(), 1.06, 0.03 * 1.06);
  EXPECT_NE(result["pictures"][1]["trouble"].get<std::string>().find("no sound PNG"),
            std::string::npos);
  EXPECT_NE(result["pictures"][2]["trouble"].get<std::string>().find("640 x 480"),
            std::string::npos);
  EXPECT_EQ(result["balls"], 1);
  EXPECT_TRUE(vision::read_picture(folder / "found/1.png.ball.png"));
  EXPECT_FALSE(fs::exists(folder / "found/2.png.ball.png"));
  const std::string csv = read_file(folder / "found/ball.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4) << csv;
  EXPECT_EQ(csv.find("\"1.png\",1,"), csv.find('\n') + 1) << csv;
  // Red as the default: another ball than this green one, and none is in sight.
  const Finished red = run(kaz({"vision", "run", "--in", folder / "left", "--calibration",
                                folder / "eyes.yml", "--out", folder / "red"}));
  EXPECT_EQ(red.exit_code, 0) << red.err;
  EXPECT_EQ(red.out.find("left out: 2.png"), 0u) << red.out;
  EXPECT_NE(red.out.find("0 balls in 1 of 3 pictures"), std::string::npos) << red.out;
}

TEST(VisionVerb, RefusesInOneSentence) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "empty");
  fs::create_directory(folder / "bad");
  write_file(folder / "bad/1.png", "no picture at all");
  write_file(folder / "grey.ppm", "P6\n20 20\n255\n" + std::string(1200, 'x'));
  const auto look = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"vision", "run", "--out", folder / "found", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(kaz(arguments));
  };
  expect_refusal(look({"--in", folder / "none", "--view", "60"}), 2, {"none", "looked into"});
  expect_refusal(look({"--in", folder / "empty", "--view", "60"}), 2, {"holds no picture"});
  expect_refusal(look({"--in", folder / "bad"}), 2, {"--calibration", "--view"});
  expect_refusal(look({"--in", folder / "bad", "--view", "60", "--modules", "smell"}), 2,
                 {"smell", "color"});
  expect_refusal(look({"--in", folder / "bad", "--view", "60", "--color", folder / "bad/1.png"}), 2,
                 {"1.png", "no JSON"});
  expect_refusal(look({"--in", folder / "bad", "--calibration", folder / "bad/1.png"}), 2,
                 {"1.png", "holds no image_width"});
  expect_refusal(look({"--in", folder / "bad", "--view", "60"}), 1,
                 {"none of the 1 pictures", "no picture that can be read"});
  expect_refusal(look({}), 2, {"--in DIR", "--left"});
  expect_refusal(look({"--left", folder / "grey.ppm", "--right", folder / "grey.ppm"}), 2,
                 {"--calibration"});
  const auto learn = [&](const std::string& region) {
    return run(kaz({"vision", "learn-color", "--in", folder / "grey.ppm", "--region", region,
                    "--out", folder / "a.json"}));
  };
  expect_refusal(learn("0,0,20,20"), 1, {"grey.ppm", "needs a hue"});
  expect_refusal(learn("0,0,21,20"), 2, {"not within"});
  expect_refusal(learn("0;0;21;20"), 2, {"120,80,40,30"});
  EXPECT_FALSE(fs::exists(folder / "a.json"));
}

}  // namespace
}  // namespace kaz::test
