// `kaz run play`: poses of a file, played by the emulated firmware, judged by the simulator's truth.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <map>

#include <gtest/gtest.h>

#include "sim/runtime/formats/mcap_reader.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

constexpr std::size_t kNeckPan = 0, kShoulder = 6;  // shared/board/joints.def

const char kWave[] = R"({"format": "kaz-poses-1", "poses": [
  {"time_s": 0, "angles_rad": {"r_sh_pitch": -0.2, "neck_pan": 0}},
  {"time_s": 1.5, "angles_rad": {"r_sh_pitch": -1.5, "neck_pan": 0.5}},
  {"time_s": 2.5, "angles_rad": {"neck_pan": -0.5}},
  {"time_s": 4, "angles_rad": {"r_sh_pitch": -0.2, "neck_pan": 0}}]})";

// True angle of a joint at each millisecond.
std::vector<double> angles_of(const std::string& path, std::size_t joint) {
  const auto recording = sim::McapRecording::load(path);
  EXPECT_TRUE(recording) << recording.error().message;
  std::vector<double> angles;
  for (const auto& message : recording->messages) {
    if (recording->topics.at(message.channel) != "/truth/joints") continue;
    double angle = 0;
    std::memcpy(&angle, message.data.data() + 8 * joint, sizeof angle);
    angles.push_back(angle);
  }
  return angles;
}

// The joint turns as the file says: its extremes are those of the file, at the times of the file.
TEST(Poses, ArePlayedByTheFirmwareAtTheirTimes) {
  const TemporaryFolder folder;
  write_file(folder / "wave.json", kWave);
  const Finished played =
      run(kaz({"run", "play", "--poses", folder / "wave.json", "--out", folder / "out"}),
          std::chrono::seconds(100));
  ASSERT_EQ(played.exit_code, 0) << played.err;
  EXPECT_NE(played.out.find("4 poses in 4.0 s"), std::string::npos) << played.out;
  const auto shoulder = angles_of(folder / "out/recording.mcap", kShoulder);
  const auto neck = angles_of(folder / "out/recording.mcap", kNeckPan);
  const auto lowest = std::ranges::min_element(shoulder), left = std::ranges::max_element(neck),
             right = std::ranges::min_element(neck);
  constexpr double kNear = 0.05;  // rad: gain, gear's play and the arm's weight
  EXPECT_NEAR(*lowest, -1.5, kNear);
  EXPECT_NEAR(*left, 0.5, kNear);
  EXPECT_NEAR(*right, -0.5, kNear);
  EXPECT_NEAR(shoulder.back(), -0.2, kNear);
  EXPECT_NEAR(neck.back(), 0, kNear);
  // From one extreme of the neck to the other the file has 1 s, in which it is at rest at both.
  EXPECT_NEAR(1e-3 * static_cast<double>(right - left), 1.0, 0.15);

  // Replayed with the file gone.
  write_file(folder / "wave.json", "");
  const Finished again = run(kaz({"replay", folder / "out"}), std::chrono::seconds(100));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("identical"), std::string::npos);
}

// At the end it hangs where it should be: what counts is the way.
TEST(Poses, AJointThatDoesNotFollowIsNoSuccess) {
  const TemporaryFolder folder;
  write_file(folder / "wave.json", kWave);
  write_file(folder / "faults", "at 1 s for 60 s joint_slipping joint r_sh_pitch 0.01\n");
  const Finished played = run(kaz({"run", "play", "--poses", folder / "wave.json", "--mcu",
                                   "native", "--faults", folder / "faults"}),
                              std::chrono::seconds(100));
  EXPECT_EQ(played.exit_code, 1) << played.out << played.err;
  EXPECT_NE(played.out.find("were not followed; largest error during the motion: "),
            std::string::npos)
      << played.out << played.err;
  EXPECT_NE(played.out.find(" degrees (r_sh_pitch, after "), std::string::npos)
      << played.out << played.err;
}

TEST(Poses, WrongOnesAreRefusedBeforeAnythingMoves) {
  const TemporaryFolder folder;
  const auto poses = [](const std::string& more) {
    return R"({"format": "kaz-poses-1", "poses": [{"time_s": 0, "angles_rad": {"neck_pan": 0}}, )" +
           more + "]}";
  };
  for (const auto& [text, hint] : std::map<std::string, std::string>{
           {"", "bad.json: line 1 is not valid JSON"},
           {poses(R"({"time_s": 1, "angles_rad": {"neck_pan": 1e999}})"),
            "bad.json: line 1: the number 1e999 is too large"},
           {poses(R"({"time_s": 1, "angles_rad": {"neck_pan": 0, "neck_pan": 0.5}})"),
            "bad.json: the key \"neck_pan\" occurs twice"},
           {poses(R"({"time_s": 1, "angles_rad": {"wing": 0}})"),
            "\"wing\", which this robot does not have"},
           {poses(R"({"time_s": 1, "angles_rad": {"r_sh_pitch": 2}})"),
            "turn r_sh_pitch to 2 rad, but the joint's range is"},
           {poses(R"({"time_s": 0.05, "angles_rad": {"neck_pan": 1}})"),
            "leave more time between the poses"}}) {
    write_file(folder / "bad.json", text);
    const Finished played =
        run(kaz({"run", "play", "--poses", folder / "bad.json", "--mcu", "native"}));
    EXPECT_EQ(played.exit_code, 2) << text;
    EXPECT_NE(played.err.find(hint), std::string::npos) << played.err;
  }
  for (const auto& [arguments, hint] : std::map<std::vector<std::string>, std::string>{
           {{"run", "play"}, "give --poses FILE"},
           {{"run", "play", "--poses", folder / "none"}, "none: cannot be read"},
           {{"run", "stand", "--poses", folder / "bad.json"}, "--poses is only valid with play"},
           {{"run", "pose", "--out", folder / "posed"}, "give --view"}}) {
    const Finished refused = run(kaz(arguments));
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder / "posed"));
    EXPECT_NE(refused.err.find(hint), std::string::npos) << refused.err;
  }
}

// Through a port, in real time, as on a real board.
TEST(Poses, ArePlayedOverAPort) {
  const TemporaryFolder folder;
  write_file(folder / "wave.json", kWave);
  Process sim(kaz({"sim", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  const Finished played = run(kaz({"run", "play", "--poses", folder / "wave.json", "--robot",
                                   "serial:" + (folder / "board")}),
                              std::chrono::seconds(60));
  EXPECT_EQ(played.exit_code, 0) << played.out << played.err;
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(std::chrono::seconds(10)).exit_code, 0);
}

}  // namespace
}  // namespace kaz::test
