// `kaz vision` on pictures of the virtual eyes: a colour learned in one is found, and bad pictures named.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"
#include "vision/image/picture_file.h"

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
  const json color = parse_json(read_file(folder / "green.json"));
  EXPECT_GT(color["share_of_region"], 0.95);
  // The whole ball is 0.5 % of the picture.
  EXPECT_LT(color["share_of_rest"], 0.01);
  EXPECT_FALSE(color.contains("warning"));
  EXPECT_EQ(color["provenance"]["date"].get<std::string>().size(), 20u);
  EXPECT_NE(color["provenance"]["command"].get<std::string>().find("learn-color"),
            std::string::npos);
  EXPECT_EQ(learned.out.find("warning"), std::string::npos) << learned.out;

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
  const json result = parse_json(found.out);
  EXPECT_EQ(result, parse_json(read_file(folder / "found/result.json")));
  ASSERT_EQ(result["pictures"].size(), 3u);
  const json& ball = result["pictures"][0];
  ASSERT_TRUE(ball["found"].get<bool>());
  EXPECT_GT(ball["confidence"], 0.8);
  // sim/worlds/ball.sdf has it at 1.02, -0.26, 0.06 m with 0.06 m of radius; the URDF has the left eye
  // at 0.03, 0.02 and, standing, about 0.3 m: 1.06 m away. The eye is turned by up to 0.01 rad. 3 % of
  // distance for noise and one sample a pixel.
  EXPECT_NEAR(ball["position_m"][0].get<double>(), 0.28, 0.011 + 0.03 * 0.28);
  EXPECT_NEAR(ball["distance_m"].get<double>(), 1.06, 0.03 * 1.06);
  EXPECT_NE(result["pictures"][1]["error"].get<std::string>().find("not a valid PNG"),
            std::string::npos);
  EXPECT_NE(result["pictures"][2]["error"].get<std::string>().find("640 x 480"), std::string::npos);
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
  const Finished first =
      run(kaz({"vision", "run", "--in", folder / "left", "--calibration", folder / "eyes.yml",
               "--frames", "1", "--out", folder / "first"}));
  EXPECT_NE(first.out.find("0 balls in 1 of 1 picture,"), std::string::npos) << first.out;
}

TEST(VisionVerb, FindsBallsInPixelsWithoutACameraModel) {
  const TemporaryFolder folder;
  draw_eyes(folder);
  const std::string picture = folder / "left/1.png";
  const std::vector<std::string> learn{"vision",   "learn-color",   "--in",  picture,
                                       "--region", "415,330,24,24", "--in",  picture,
                                       "--region", "418,333,18,18", "--out", folder / "green.json"};
  const Finished learned = run(kaz(learn));
  ASSERT_EQ(learned.exit_code, 0) << learned.err;
  auto one_region = learn;
  one_region.erase(one_region.begin() + 8, one_region.begin() + 10);
  expect_refusal(run(kaz(one_region)), 2, {"2 pictures", "1 region", "one region for each"});

  const Finished found = run(kaz({"vision", "run", "--in", folder / "left", "--color",
                                  folder / "green.json", "--out", folder / "found", "--json"}));
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const json result = parse_json(found.out);
  EXPECT_FALSE(result.contains("radius_m"));
  const json& ball = result["pictures"][0];
  ASSERT_TRUE(ball["found"].get<bool>());
  EXPECT_FALSE(ball.contains("distance_m"));
  ASSERT_EQ(ball["balls"].size(), 1u);
  EXPECT_EQ(ball["balls"][0]["center_px"], ball["center_px"]);
  EXPECT_NEAR(ball["center_px"][0].get<double>(), 427, 2);
  EXPECT_NEAR(ball["center_px"][1].get<double>(), 341.5, 2);
  EXPECT_NEAR(ball["radius_px"].get<double>(), 23.3, 0.7);
  const std::string csv = read_file(folder / "found/ball.csv");
  EXPECT_NE(csv.find(",,,,,0."), std::string::npos) << csv;
  EXPECT_TRUE(vision::read_picture(folder / "found/1.png.ball.png"));
}

TEST(VisionVerb, WarnsOfAColourThatMuchOfThePictureHas) {
  const TemporaryFolder folder;
  std::string picture = "P6\n64 48\n255\n";  // its left half is red
  for (int n = 0; n < 64 * 48; ++n) picture += n % 64 < 32 ? "\xc0\x10\x10" : "\x60\x60\x60";
  write_file(folder / "red.ppm", picture);
  const std::vector<std::string> learn{"vision",   "learn-color", "--in",  folder / "red.ppm",
                                       "--region", "10,10,10,10", "--out", folder / "red.json"};
  const Finished learned = run(kaz(learn));
  EXPECT_EQ(learned.exit_code, 0) << learned.err;
  // (32 * 48 - 100) of 64 * 48 - 100 pixels.
  EXPECT_NE(learned.out.find("\nwarning: 48 % of the rest of the picture"), std::string::npos)
      << learned.out;
  const json color = parse_json(read_file(folder / "red.json"));
  EXPECT_NE(color.value("warning", "").find("mark only the object"), std::string::npos) << color;
  // With all of the red in the region there is no such rest.
  auto whole = learn;
  whole[5] = "0,0,32,48";
  const Finished marked = run(kaz(whole));
  EXPECT_EQ(marked.exit_code, 0) << marked.err;
  EXPECT_EQ(marked.out.find("warning"), std::string::npos) << marked.out;
}

// A recording carries the posture, so the floor is known; the same file gives the same frames.
TEST(VisionVerb, FindsTheFloorInARecording) {
  const TemporaryFolder folder;
  const Finished seen =
      run(kaz({"run", "search-ball", "--mcu", "native", "--duration", "1", "--record-pictures",
               "--modules", "planes", "--out", folder / "seen", "--json"}));
  const json recorded = parse_json(seen.out);
  ASSERT_TRUE(recorded.is_object()) << seen.err;
  const json& planes = recorded["vision"]["planes"];
  EXPECT_GE(planes["frames"], 25);
  EXPECT_EQ(planes["dropped"], 0);
  EXPECT_GT(planes["computing_ms"]["median"], 0);
  // Camera 15 ms, depth 20, planes 30.
  EXPECT_EQ(planes["age_ms"]["max"], 65);
  const std::string table = read_file(folder / "seen/vision.csv");
  EXPECT_NE(table.find("\nplanes,20,"), std::string::npos);

  std::vector<std::string> tables;
  for (const char* out : {"one", "two"}) {
    const Finished found = run(kaz({"vision", "run", "--in", folder / "seen/recording.mcap",
                                    "--modules", "planes", "--out", folder / out, "--json"}));
    ASSERT_EQ(found.exit_code, 0) << found.err;
    const json result = parse_json(found.out);
    int floors = 0;
    for (const json& frame : result["frames"]) {
      if (!frame.contains("planes")) continue;
      for (const json& segment : frame["planes"]) floors += segment.value("floor", false);
    }
    // In the last third of the second the head looks at the horizon.
    EXPECT_GE(floors, 15);
    EXPECT_TRUE(vision::read_picture(folder / (std::string(out) + "/000020.vision.png")));
    tables.push_back(read_file(folder / (std::string(out) + "/frames.csv")));
  }
  EXPECT_EQ(tables[0], tables[1]);

  // Of the first pairs alone nothing else is computed, and what is exported counts as a module.
  const auto first_two = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"vision", "run",   "--in",           folder / "seen", "--frames",
                                 "2",      "--out", folder / "first", "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return run(kaz(all));
  };
  const Finished first = first_two({"--export", "depth"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const json result = parse_json(first.out);
  EXPECT_EQ(result["modules"], (json{"color", "depth"}));
  EXPECT_EQ(result["frames_looked_at"], 2);
  EXPECT_EQ(result["vision"]["color"]["frames"], 2) << result["vision"];
  EXPECT_EQ(result["vision"]["depth"]["frames"], 2) << result["vision"];
  ASSERT_EQ(result["frames"].size(), 2u);
  EXPECT_TRUE(fs::exists(folder / "first/000001.depth.png"));

  // Eyes of 320 px over 80 degrees, 0.04 m apart: 16 px of disparity are 0.4767 m.
  const Finished near = first_two({"--export", "depth", "--nearest", "0.05"}),
                 far = first_two({"--export", "depth", "--nearest", "0.476"});
  ASSERT_EQ(near.exit_code, 0) << near.err;
  ASSERT_EQ(far.exit_code, 0) << far.err;
  EXPECT_NE(parse_json(near.out)["frames"], parse_json(far.out)["frames"]);
  const std::string kept = read_file(folder / "first/result.json");
  for (const char* useless : {"0.48", "14", "0.02"})
    expect_refusal(first_two({"--export", "depth", "--nearest", useless}), 2,
                   {std::string("--nearest ") + useless, "0.024 to 0.476 m", "14 cm is 0.14"});
  expect_refusal(first_two({"--nearest", "0.3"}), 2, {"--nearest", "--modules color", "add depth"});
  EXPECT_EQ(read_file(folder / "first/result.json"), kept);
}

// Nothing but the robot's head moves; its posture is that of noisy potentiometers, and its shoulders
// come into view.
TEST(VisionVerb, FindsNothingThatMovesWhereNothingDoes) {
  const TemporaryFolder folder;
  const Finished seen =
      run(kaz({"run", "search-ball", "--mcu", "native", "--eyes", "real", "--duration", "3",
               "--record-pictures", "--out", folder / "seen"}));
  ASSERT_TRUE(fs::exists(folder / "seen/recording.mcap")) << seen.err;
  const Finished found = run(kaz({"vision", "run", "--in", folder / "seen/recording.mcap",
                                  "--modules", "moving", "--out", folder / "found", "--json"}));
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const json result = parse_json(found.out);
  int said = 0, quiet = 0;
  for (const json& frame : result["frames"]) {
    if (!frame.contains("moving")) continue;
    ++said;
    quiet += frame["moving"].empty() ? 1 : 0;
  }
  EXPECT_GE(said, 80);
  // The whole run has 94 % without (docs/explanation/vision.md says why not all): a little less is its
  // scatter.
  EXPECT_GE(quiet, 0.9 * said);
}

TEST(VisionVerb, LooksThroughALiveCamera) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--world", "ball", "--mcu", "native", "--serial", folder / "board",
                   "--cameras", folder / "eyes"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  const Finished found = run(
      kaz({"vision", "run", "--in", folder / "eyes", "--robot", "serial:" + (folder / "board"),
           "--modules", "color,planes", "--frames", "12", "--out", folder / "found", "--json"}));
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const json result = parse_json(found.out);
  EXPECT_GE(result["frames"].size(), 12u);
  int with_floor = 0;
  for (const json& frame : result["frames"]) {
    if (!frame.contains("planes")) continue;
    for (const json& segment : frame["planes"]) with_floor += segment.value("floor", false);
  }
  EXPECT_GE(with_floor, 4);
  const auto look = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"vision", "run", "--in", folder / "eyes", "--out", folder / "few"};
    all.insert(all.end(), more.begin(), more.end());
    return run(kaz(all));
  };
  expect_refusal(look({"--view", "60"}), 2, {"--view", "has its own camera model"});
  expect_refusal(look({"--modules", "depth", "--nearest", "0.8"}), 2, {"0.476 m"});
  // Pairs that come later are none of those asked for.
  const Finished few = look({"--frames", "3"});
  EXPECT_EQ(few.exit_code, 0) << few.err;
  EXPECT_NE(few.out.find("3 of 3 pairs processed"), std::string::npos) << few.out;
  for (const char* more : {"4 pairs", "5 pairs", "6 pairs"})
    EXPECT_EQ(few.err.find(more), std::string::npos) << few.err;
  // Its camera ends, and what was seen until then is kept.
  Process watching(kaz({"vision", "run", "--in", folder / "eyes", "--out", folder / "until"}));
  ASSERT_TRUE(watching.wait_for_output("pairs", std::chrono::seconds(20)));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  sim.signal(SIGINT);
  const Finished until = watching.wait(std::chrono::seconds(20));
  EXPECT_EQ(until.exit_code, 3) << until.err;
  EXPECT_NE(until.err.find("stopped"), std::string::npos) << until.err;
  EXPECT_GE(parse_json(read_file(folder / "until/result.json"))["frames_looked_at"], 5);
}

// Overlays take longer than looking: those that still wait at Ctrl-C are dropped and counted.
TEST(VisionVerb, CtrlCDoesNotWaitForOverlays) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--world", "ball", "--mcu", "native", "--serial", folder / "board",
                   "--cameras", folder / "eyes"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  Process watching(kaz({"vision", "run", "--in", folder / "eyes", "--modules", "color,planes",
                        "--export", "depth,points", "--out", folder / "found"}));
  ASSERT_TRUE(watching.wait_for_output("pairs", std::chrono::seconds(20)));
  EXPECT_FALSE(watching.prints_within("interrupted", std::chrono::seconds(3)));
  const double cpu_before = watching.cpu_s();
  const auto signalled = std::chrono::steady_clock::now();
  watching.signal(SIGINT);
  const Finished ended = watching.wait(std::chrono::seconds(20));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - signalled;
  EXPECT_EQ(ended.exit_code, 130) << ended.err;
  // On a loaded machine a program may wait for its turn, but does not work for long.
  EXPECT_TRUE(took.count() < 1 || ended.cpu_s - cpu_before < 1)
      << took.count() << " s, worked " << ended.cpu_s - cpu_before;
  const json result = parse_json(read_file(folder / "found/result.json"));
  EXPECT_TRUE(result.value("interrupted", false));
  EXPECT_TRUE(fs::exists(folder / "found/frames.csv"));
  // Each pair has an overlay of its panels, and the two exports of its depth.
  std::size_t written = 0, expected = 0;
  for (const auto& file : fs::directory_iterator(folder / "found")) {
    const std::string name = file.path().filename();
    written += name.ends_with(".vision.png") || name.ends_with(".depth.png") ||
               name.ends_with(".points.ply");
  }
  for (const json& frame : result["frames"]) {
    expected += frame.contains("ball") || frame.contains("planes") || frame.contains("depth");
    expected += frame.contains("depth") ? 2 : 0;
  }
  const auto not_written = result.value("files_not_written", std::size_t{0});
  EXPECT_EQ(written + not_written, expected);
  const std::string words = "not written: " + std::to_string(not_written) + " file";
  EXPECT_EQ(ended.err.find(words) != std::string::npos, not_written > 0) << ended.err;
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
  expect_refusal(look({"--in", folder / "none", "--view", "60"}), 2, {"none", "no such folder"});
  expect_refusal(look({"--in", "v4l2:/dev/a,/dev/b"}), 2, {"v4l2:/dev/a,/dev/b", "--calibration"});
  expect_refusal(look({"--in", "v4l2:/dev/a", "--calibration", "x"}), 2, {"two devices", "as in"});
  expect_refusal(look({"--in", "v4l2:/dev/a,/dev/b", "--calibration", folder / "grey.ppm"}), 2,
                 {"grey.ppm", "image_width"});
  expect_refusal(look({"--in", folder / "empty", "--view", "60"}), 2, {"contains no picture"});
  write_file(folder / "nothing.png", "");
  expect_refusal(look({"--in", folder / "nothing.png", "--view", "60"}), 2,
                 {"nothing.png", "the file is empty"});
  expect_refusal(look({"--left", folder / "grey.ppm", "--right", folder / "grey.ppm", "--modules",
                       "depth,depth"}),
                 2, {"names 'depth' twice"});
  expect_refusal(look({"--in", folder / "bad", "--view", "60", "--modules", "smell"}), 2,
                 {"smell", "color"});
  expect_refusal(look({"--in", folder / "bad", "--view", "60", "--color", folder / "bad/1.png"}), 2,
                 {"1.png", "is not valid JSON"});
  write_file(folder / "color.json", R"({"hue_min": 1, "hue_max": 1e999})");
  expect_refusal(look({"--in", folder / "bad", "--view", "60", "--color", folder / "color.json"}),
                 2, {"color.json", "line 1: the number 1e999 is too large"});
  write_file(folder / "color.json", R"({"hue_min": 1, "hue_min": 2, "hue_max": 2})");
  expect_refusal(look({"--in", folder / "bad", "--view", "60", "--color", folder / "color.json"}),
                 2, {"color.json", "the key \"hue_min\" occurs twice"});
  expect_refusal(look({"--in", folder / "bad", "--calibration", folder / "bad/1.png"}), 2,
                 {"1.png", "image_width is missing"});
  expect_refusal(look({"--in", folder / "bad", "--view", "60"}), 1,
                 {"none of 1 picture in", "not a supported picture"});
  expect_refusal(look({}), 2, {"--in", "--left"});
  expect_refusal(look({"--left", folder / "grey.ppm", "--right", folder / "grey.ppm"}), 2,
                 {"--calibration"});
  expect_refusal(
      look({"--left", folder / "grey.ppm", "--right", folder / "grey.ppm", "--modules", "flow"}), 2,
      {"--modules flow", "pairs of files contain only pictures"});
  expect_refusal(look({"--left", folder / "grey.ppm", "--right", folder / "grey.ppm", "--robot",
                       "serial:board"}),
                 2, {"--robot", "live camera"});
  expect_refusal(look({"--in", folder / "bad", "--view", "60", "--nearest", "0.3"}), 2,
                 {"--nearest", "pairs"});
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
