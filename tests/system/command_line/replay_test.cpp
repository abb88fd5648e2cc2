// `kaz replay`: an unchanged run is identical, a changed one reports where it begins to differ.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;

TEST(Replay, IdenticalUnlessSomethingIsChanged) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", file = out + "/recording.mcap";
  const Finished made =
      run(kaz({"run", "search-ball", "--mcu", "native", "--seed", "4", "--out", out}),
          std::chrono::seconds(100));
  ASSERT_EQ(made.exit_code, 0) << made.err;

  const Finished same = run(kaz({"replay", file, "--json"}), std::chrono::seconds(100));
  EXPECT_EQ(same.exit_code, 0) << same.err << same.out;
  const json result = parse_json(same.out);
  ASSERT_TRUE(result.is_object()) << same.out;
  EXPECT_EQ(result["identical"], true);
  EXPECT_EQ(result["mode"], "simulation");
  EXPECT_GT(result["messages"].get<int>(), 1000);

  const Finished other =
      run(kaz({"replay", file, "--seed", "5", "--json"}), std::chrono::seconds(100));
  EXPECT_EQ(other.exit_code, 1) << other.err;
  const json difference = parse_json(other.out);
  ASSERT_TRUE(difference.is_object()) << other.out;
  EXPECT_EQ(difference["identical"], false);
  EXPECT_LT(difference["time_s"].get<double>(), 1.0);  // noise is there from the first tick on
  EXPECT_NE(difference["recorded"], difference["now"]);
  // A number, not a row of bytes.
  EXPECT_EQ(difference["topic"], "/board/analog");
  EXPECT_EQ(difference["recorded"].get<std::string>().find("code["), 0u) << difference["recorded"];
  EXPECT_EQ(difference["now"].get<std::string>().find("code["), 0u) << difference["now"];
}

json replayed(const std::string& file, std::vector<std::string> more, int exit_code) {
  std::vector<std::string> arguments{"replay", file, "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished done = run(kaz(arguments), std::chrono::seconds(100));
  EXPECT_EQ(done.exit_code, exit_code) << done.err << done.out;
  json result = parse_json(done.out);
  EXPECT_TRUE(result.is_object()) << done.out;
  return result;
}

// The digests of the pictures are in the recording: another renderer would not be identical.
TEST(Replay, DrawsByTheRecordedRenderer) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", file = out + "/recording.mcap";
  const Finished made = run(kaz({"run", "search-ball", "--mcu", "native", "--eyes", "real",
                                 "--renderer", "opengl", "--out", out, "--json"}),
                            std::chrono::seconds(100));
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(parse_json(made.out)["renderer"], "opengl") << made.out;
  EXPECT_EQ(replayed(file, {}, 0)["identical"], true);

  const Finished wrong = run(kaz({"run", "search-ball", "--renderer", "vulkan"}));
  EXPECT_EQ(wrong.exit_code, 2) << wrong.out;
  for (const char* word : {"--renderer", "vulkan", "opengl", "raster"})
    EXPECT_NE(wrong.err.find(word), std::string::npos) << wrong.err;
}

// Ctrl-C ends the recording, and the replay with it: of the 3000 s nothing is simulated past its end.
TEST(Replay, TheWholeOfAnInterruptedRunEndsWithItsRecording) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", file = out + "/recording.mcap";
  Process interrupted(
      kaz({"run", "track-ball", "--mcu", "native", "--duration", "3000", "--out", out}));
  ASSERT_TRUE(interrupted.wait_for_output(": track", std::chrono::seconds(60)));
  interrupted.signal(SIGINT);
  EXPECT_NE(interrupted.wait(std::chrono::seconds(30)).exit_code, 0);
  const json whole = replayed(file, {"--whole"}, 0);
  EXPECT_EQ(whole["identical"], true) << whole;
  EXPECT_GT(whole["cut_off_s"].get<double>(), 0.5) << whole;
}

TEST(Replay, TheHostAloneOnWhatItSaw) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", file = out + "/recording.mcap";
  const Finished made =
      run(kaz({"run", "search-ball", "--mcu", "native", "--record-pictures", "--out", out}),
          std::chrono::seconds(100));
  ASSERT_EQ(made.exit_code, 0) << made.err;

  const json same = replayed(file, {}, 0);
  EXPECT_EQ(same["mode"], "host");
  EXPECT_EQ(same["identical"], true);
  EXPECT_GT(same["bytes_to_board"].get<int>(), 1000);
  EXPECT_GT(same["pairs"].get<int>(), 20);
  EXPECT_GT(same["behavior_records"].get<int>(), 100);

  // It gives up before it has found anything: motors off instead of the next posture.
  const json other = replayed(file, {"--set", "seconds=1"}, 1);
  EXPECT_EQ(other["identical"], false);
  const double time = other["difference"]["time_s"];
  EXPECT_GT(time, 1.0);
  EXPECT_LT(time, 1.5);
  EXPECT_NE(other["difference"]["recorded"], other["difference"]["now"]);
  EXPECT_NE(other["difference"]["where"].get<std::string>().find("to the board"),
            std::string::npos);

  EXPECT_EQ(replayed(file, {"--whole"}, 0)["mode"], "simulation");

  // Killed in the middle: what is there is replayed to its end, both ways; a host that does otherwise
  // before that is still found out.
  const std::string bytes = read_file(file), cut = folder / "cut.mcap";
  write_file(cut, bytes.substr(0, bytes.size() * 6 / 10));
  for (const char* mode : {"--host", "--whole"}) {
    const json rest = replayed(cut, {mode}, 0);
    EXPECT_EQ(rest["identical"], true) << rest;
    EXPECT_GT(rest["cut_off_s"].get<double>(), 1.0) << rest;
  }
  EXPECT_FALSE(same.contains("cut_off_s"));
  EXPECT_EQ(replayed(cut, {"--set", "seconds=1"}, 1)["identical"], false);
  const Finished seen =
      run(kaz({"vision", "run", "--in", cut, "--out", folder / "found"}), std::chrono::seconds(60));
  EXPECT_EQ(seen.exit_code, 0) << seen.err;
  EXPECT_NE(seen.err.find("was cut off; processed up to its last complete step at "),
            std::string::npos)
      << seen.err;
  // At whatever byte it ends it is replayed, or there is nothing that could be.
  for (std::size_t part = 0; part < 8; ++part) {
    write_file(cut, bytes.substr(0, bytes.size() / 8 * part + 13 * part));
    const Finished done = run(kaz({"replay", cut, "--host"}), std::chrono::seconds(60));
    EXPECT_TRUE(done.exit_code == 0 || (done.exit_code == 2 && part < 3)) << part << done.err;
    if (done.exit_code == 0) {
      EXPECT_NE(done.out.find("was cut off"), std::string::npos) << done.out;
    }
  }
}

TEST(Replay, WithoutPicturesOnlyWhatNeedsNone) {
  const TemporaryFolder folder;
  const std::string stood = folder / "stood", sought = folder / "sought";
  for (const auto& [behavior, out] : {std::pair{"stand", stood}, {"search-ball", sought}})
    ASSERT_EQ(
        run(kaz({"run", behavior, "--mcu", "native", "--out", out}), std::chrono::seconds(100))
            .exit_code,
        0);
  EXPECT_EQ(replayed(stood + "/recording.mcap", {}, 0)["mode"], "host");
  const json other = replayed(stood + "/recording.mcap", {"--set", "posture=straight"}, 1);
  EXPECT_NE(other["difference"]["now"].get<std::string>().find("`"), std::string::npos) << other;

  const Finished blind =
      run(kaz({"replay", sought + "/recording.mcap", "--host"}), std::chrono::seconds(20));
  EXPECT_EQ(blind.exit_code, 2);
  EXPECT_NE(blind.err.find("--record-pictures"), std::string::npos) << blind.err;
}

TEST(Replay, SaysWhatIsNoRecording) {
  const TemporaryFolder folder;
  const Finished none = run(kaz({"replay", folder / "none"}), std::chrono::seconds(20));
  EXPECT_EQ(none.exit_code, 2);
  std::ofstream(folder / "text") << "no recording at all";
  const Finished text = run(kaz({"replay", folder / "text"}), std::chrono::seconds(20));
  EXPECT_EQ(text.exit_code, 2);
  EXPECT_NE(text.err.find("not an MCAP file"), std::string::npos) << text.err;
}

// The log ends within a message; an answer of the virtual board has other counters than the recorded one.
TEST(Replay, ACanLogIsSentToTheVirtualBoard) {
  const std::string log = "tools/fuzz/inputs/seeds/can_log/requests_and_answers.log";
  const Finished sent = run(kaz({"replay", log, "--json"}), std::chrono::seconds(100));
  const json result = parse_json(sent.out);
  ASSERT_TRUE(result.is_object()) << sent.out << sent.err;
  EXPECT_EQ(sent.exit_code, result["identical"] == true ? 0 : 1);
  EXPECT_EQ(result["robot"], "the simulator");
  EXPECT_GE(result["requests"].get<int>(), 3);
  EXPECT_GE(result["answers"].get<int>(), 3);
  for (const json& one : result["differences"]) EXPECT_NE(one["what"], "") << one;

  const Finished host = run(kaz({"replay", log, "--host"}), std::chrono::seconds(10));
  EXPECT_EQ(host.exit_code, 2);
  EXPECT_NE(host.err.find("--host is not valid with a CAN log"), std::string::npos) << host.err;
  const Finished robot =
      run(kaz({"replay", "none.mcap", "--robot", "sim"}), std::chrono::seconds(10));
  EXPECT_EQ(robot.exit_code, 2);
  EXPECT_NE(robot.err.find("--robot is only valid with a CAN log"), std::string::npos) << robot.err;
  const Finished bus =
      run(kaz({"replay", log, "--robot", "feetech:/dev/none"}), std::chrono::seconds(10));
  EXPECT_EQ(bus.exit_code, 2);
  EXPECT_NE(bus.err.find("is not valid with a CAN log"), std::string::npos) << bus.err;
}

}  // namespace
}  // namespace kaz::test
