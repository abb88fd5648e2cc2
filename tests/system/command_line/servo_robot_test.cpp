// A robot on a servo bus, driven by `kaz run` as by any other board: the arm of the virtual bus.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/control_socket_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

const std::string kArm = std::string(KAZ_TREE) + "/sim/robots/so101/so101.urdf";

const char kWave[] = R"({"format": "kaz-poses-1", "poses": [
  {"time_s": 0, "angles_rad": {"shoulder_pan": 0, "shoulder_lift": 0, "elbow_flex": 0, "wrist_flex": 0}},
  {"time_s": 1.5, "angles_rad": {"shoulder_pan": 0.6, "elbow_flex": -0.5}},
  {"time_s": 3, "angles_rad": {"shoulder_pan": -0.4, "elbow_flex": 0.2, "wrist_flex": 0.5}},
  {"time_s": 4, "angles_rad": {"shoulder_pan": 0, "elbow_flex": 0, "wrist_flex": 0}}]})";

TEST(ServoRobot, TheArmPlaysPosesOverItsBus) {
  const TemporaryFolder folder;
  write_file(folder / "wave.json", kWave);
  Process sim(kaz({"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", folder / "arm"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  const std::vector<std::string> robot{"--robot", "feetech:" + (folder / "arm"), "--robot-file",
                                       kArm};
  std::vector<std::string> play{"run",   "play",        "--poses", folder / "wave.json",
                                "--out", folder / "out"};
  play.insert(play.end(), robot.begin(), robot.end());
  const Finished played = run(kaz(play), std::chrono::seconds(60));
  EXPECT_EQ(played.exit_code, 0) << played.out << played.err;
  EXPECT_NE(played.out.find("4 poses in 4.0 s"), std::string::npos) << played.out;
  const auto result = parse_json(read_file(folder / "out/result.json"));
  EXPECT_EQ(result["outcome"], "done");
  EXPECT_TRUE(std::filesystem::exists(folder / "out/recording.mcap"));

  std::vector<std::string> stand{"run", "stand"};
  stand.insert(stand.end(), robot.begin(), robot.end());
  const Finished stood = run(kaz(stand), std::chrono::seconds(60));
  EXPECT_EQ(stood.exit_code, 0) << stood.out << stood.err;

  // Ctrl-C: the joints are let go within a second.
  play.back() = kArm;
  Process broken(kaz(play));
  ASSERT_TRUE(broken.wait_for_output("play", std::chrono::seconds(30)));
  const auto torque = [&] {
    const auto status = parse_json(query_control(folder / "arm.ctl", "status"));
    int on = 0;
    for (const auto& servo : status["servos"]) on += servo["torque"].get<int>() != 0;
    return on;
  };
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(torque(), 6);
  broken.signal(SIGINT);
  EXPECT_EQ(broken.wait(std::chrono::seconds(5)).exit_code, 128 + SIGINT);
  EXPECT_EQ(torque(), 0);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(std::chrono::seconds(10)).exit_code, 0);
}

TEST(ServoRobot, AJointWithoutStopsIsPlayed) {
  const TemporaryFolder folder;
  write_file(folder / "wave.json", kWave);
  const auto arm = std::filesystem::path(kArm).parent_path();
  for (const char* file : {"motor.xml", "bus.json"})
    std::filesystem::copy(arm / file, folder / file);
  std::string urdf = read_file(kArm);
  const std::string limited = "name=\"shoulder_pan\" type=\"revolute\"";
  const auto at = urdf.find(limited);
  ASSERT_NE(at, std::string::npos);
  urdf.replace(at, limited.size(), "name=\"shoulder_pan\" type=\"continuous\"");
  write_file(folder / "free.urdf", urdf);
  Process sim(kaz({"sim", "--bus", "feetech", "--robot-file", folder / "free.urdf", "--serial",
                   folder / "arm", "--motor", "sts3215-6v"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  const Finished played =
      run(kaz({"run", "play", "--poses", folder / "wave.json", "--robot",
               "feetech:" + (folder / "arm"), "--robot-file", folder / "free.urdf"}),
          std::chrono::seconds(60));
  EXPECT_EQ(played.exit_code, 0) << played.out << played.err;
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(std::chrono::seconds(10)).exit_code, 0);
}

// An adapter that holds bytes for 16 ms and returns what the host sends.
TEST(ServoRobot, AdaptersWithFaultsAreScannedAndPlayed) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", folder / "arm"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  const std::string port = "feetech:" + (folder / "arm") + "@1000000";
  for (const char* fault : {"latency 0.016", "echo on"}) {
    const auto reply = parse_json(query_control(folder / "arm.ctl", fault));
    EXPECT_TRUE(reply["ok"].get<bool>());
    const Finished scanned = run(kaz({"bus", "scan", "--robot", port, "--ids", "0-9", "--json"}),
                                 std::chrono::seconds(100));
    EXPECT_EQ(scanned.exit_code, 0) << scanned.out << scanned.err;
    EXPECT_EQ(parse_json(scanned.out)["servos"].size(), 6u) << scanned.out;
    const Finished stood =
        run(kaz({"run", "stand", "--robot", port, "--robot-file", kArm}), std::chrono::seconds(60));
    EXPECT_EQ(stood.exit_code, 0) << stood.out << stood.err;
  }
  for (const char* wrong : {"latency 2", "latency", "echo 1"})
    EXPECT_FALSE(parse_json(query_control(folder / "arm.ctl", wrong))["ok"].get<bool>());
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(std::chrono::seconds(10)).exit_code, 0);
}

// On a wire that damages bytes nothing is called off that is not: what the end says agrees with the servos.
TEST(ServoRobot, TheEndOfARunNamesServosThatDoNotConfirm) {
  const TemporaryFolder folder;
  write_file(folder / "wave.json", kWave);
  Process sim(kaz({"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", folder / "arm"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  const std::string control = folder / "arm.ctl";
  for (const char* damage : {"0.15", "0.6"}) {
    Process play(kaz({"run", "play", "--poses", folder / "wave.json", "--robot",
                      "feetech:" + (folder / "arm"), "--robot-file", kArm}));
    ASSERT_TRUE(play.wait_for_output("play", std::chrono::seconds(30)));
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    query_control(control, std::string("damage ") + damage);
    const Finished ended = play.wait(std::chrono::seconds(40));
    query_control(control, "damage 0");
    EXPECT_NE(ended.exit_code, 0) << ended.out;
    const bool called_off = ended.err.find("motors off (") != std::string::npos;
    const auto advice = ended.err.rfind("cut the power");
    EXPECT_TRUE(called_off || advice != std::string::npos) << ended.err;
    const std::string last = ended.err.substr(ended.err.rfind('\n', advice) + 1);
    for (const auto& servo : parse_json(query_control(control, "status"))["servos"]) {
      if (servo["torque"] == 0) continue;
      EXPECT_FALSE(called_off) << ended.err;
      EXPECT_NE(last.find(servo["joint"].get<std::string>() + " (id "), std::string::npos) << last;
    }
    if (damage == std::string("0.6")) {
      EXPECT_FALSE(called_off) << "no answer came through";
    }
  }
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(std::chrono::seconds(10)).exit_code, 0);
}

// What an owner does: look, record by hand, play it on the same bus.
TEST(ServoRobot, AMotionByHandIsRecordedAndPlayed) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", folder / "arm"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  const std::vector<std::string> robot{"--robot", "feetech:" + (folder / "arm"), "--robot-file",
                                       kArm};
  const auto with_robot = [&](std::vector<std::string> words, std::vector<std::string> more = {}) {
    words.insert(words.end(), robot.begin(), robot.end());
    words.insert(words.end(), more.begin(), more.end());
    return kaz(words);
  };
  const auto turn = [&](const std::string& to, int ms) {
    query_control(folder / "arm.ctl", "turn " + to);
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
  };
  for (const char* joint : {"shoulder_lift 0", "elbow_flex 0", "wrist_flex 0", "wrist_roll 0"})
    turn(joint, 0);
  turn("shoulder_pan 0", 1200);
  const Finished status = run(with_robot({"bus", "status"}, {"--json"}));
  EXPECT_EQ(status.exit_code, 0) << status.out << status.err;
  const auto looked = parse_json(status.out);
  ASSERT_EQ(looked["servos"].size(), 6u) << status.out;
  EXPECT_NEAR(looked["servos"][0]["angle_deg"].get<double>(), 0, 3);
  EXPECT_NEAR(looked["servos"][0]["volts"].get<double>(), 7.4, 0.3);
  EXPECT_EQ(looked["servos"][5]["torque"], false);
  EXPECT_TRUE(looked["servos"][0].contains("amps"));

  // Nobody moves anything: nothing is written.
  const std::string file = folder / "motion.json";
  const Finished still = run(with_robot({"bus", "record"}, {"--out", file, "--seconds", "1"}),
                             std::chrono::seconds(20));
  EXPECT_EQ(still.exit_code, 1) << still.out;
  EXPECT_NE(still.err.find("no joint was moved"), std::string::npos) << still.err;
  EXPECT_FALSE(std::filesystem::exists(file));

  Process recording(with_robot({"bus", "record"}, {"--out", file, "--seconds", "7", "--json"}));
  std::this_thread::sleep_for(std::chrono::milliseconds(900));
  turn("shoulder_pan 40", 900);
  turn("wrist_flex -50", 900);
  turn("shoulder_pan -30", 1500);
  turn("wrist_flex 0", 900);
  const Finished recorded = recording.wait(std::chrono::seconds(20));
  ASSERT_EQ(recorded.exit_code, 0) << recorded.out << recorded.err;
  const auto facts = parse_json(recorded.out);
  EXPECT_GT(facts["poses"].get<int>(), 15);
  EXPECT_LE(facts["missing"], 7);  // 1 %
  double lowest = 0, highest = 0;
  const auto poses = parse_json(read_file(file));
  for (const auto& pose : poses["poses"]) {
    lowest = std::min(lowest, pose["angles_rad"]["shoulder_pan"].get<double>());
    highest = std::max(highest, pose["angles_rad"]["shoulder_pan"].get<double>());
  }
  EXPECT_NEAR(highest, 40 * 0.01745, 0.06);
  EXPECT_NEAR(lowest, -30 * 0.01745, 0.06);

  turn("off", 0);
  const Finished played =
      run(with_robot({"run", "play", "--poses", file}, {"--out", folder / "out"}),
          std::chrono::seconds(60));
  EXPECT_EQ(played.exit_code, 0) << played.out << played.err;
  const auto result = parse_json(read_file(folder / "out/result.json"));
  EXPECT_EQ(result["outcome"], "done");
  const auto servos = parse_json(query_control(folder / "arm.ctl", "status"));
  EXPECT_NEAR(servos["servos"][0]["angle_deg"].get<double>(), -30, 6);

  // Without power nobody answers.
  query_control(folder / "arm.ctl", "power off");
  const Finished silent = run(with_robot({"bus", "status"}));
  EXPECT_EQ(silent.exit_code, 1) << silent.out;
  EXPECT_NE(silent.out.find("does not answer"), std::string::npos) << silent.out;
  const Finished lost = run(with_robot({"bus", "record"}, {"--out", file, "--seconds", "1"}));
  EXPECT_EQ(lost.exit_code, 3) << lost.err;
  EXPECT_EQ(run(kaz({"bus", "status", "--robot", "sim", "--robot-file", kArm})).exit_code, 2);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(std::chrono::seconds(10)).exit_code, 0);
}

// Over DYNAMIXEL's protocol; then the supply is too low.
TEST(ServoRobot, TheHumanoidPlaysPosesAndSaysWhatAServoReports) {
  const std::string mini = std::string(KAZ_TREE) + "/sim/robots/mini/mini.urdf";
  const TemporaryFolder folder;
  write_file(folder / "greet.json", R"({"format": "kaz-poses-1", "poses": [
  {"time_s": 0, "angles_rad": {"left_shoulder": 0, "left_elbow": 0, "head_pan": 0}},
  {"time_s": 1.5, "angles_rad": {"left_shoulder": -2, "left_elbow": -1, "left_knee_pitch": 1}},
  {"time_s": 3, "angles_rad": {"left_shoulder": 0, "left_elbow": 0, "left_knee_pitch": 0}}]})");
  Process sim(kaz({"sim", "--bus", "dynamixel", "--robot-file", mini, "--serial", folder / "mini",
                   "--suspended"}));
  ASSERT_TRUE(sim.wait_for_output("ready: 18 servos", std::chrono::seconds(30)));
  const std::vector<std::string> play{"run",          "play",
                                      "--poses",      folder / "greet.json",
                                      "--out",        folder / "out",
                                      "--robot",      "dynamixel:" + (folder / "mini"),
                                      "--robot-file", mini};
  const Finished played = run(kaz(play), std::chrono::seconds(60));
  EXPECT_EQ(played.exit_code, 0) << played.out << played.err;
  EXPECT_NE(played.out.find("3 poses in 3.0 s"), std::string::npos) << played.out;
  const auto result = parse_json(read_file(folder / "out/result.json"));
  EXPECT_LT(result["largest_error_at_the_end_deg"].get<double>(), 3);

  // 3.2 V is below the XL330's limit: it shuts down.
  query_control(folder / "mini.ctl", "supply 3.2");
  const Finished low = run(kaz(play), std::chrono::seconds(60));
  EXPECT_NE(low.exit_code, 0);
  EXPECT_NE(low.out.find("supply too low"), std::string::npos) << low.out << low.err;
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(std::chrono::seconds(10)).exit_code, 0);

  const auto other = run(kaz({"run", "play", "--poses", folder / "greet.json", "--robot",
                              "feetech:" + (folder / "mini"), "--robot-file", mini}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("describes a dynamixel bus"), std::string::npos) << other.err;
}

TEST(ServoRobot, WhatIsWrongIsNamed) {
  const TemporaryFolder folder;
  write_file(folder / "wave.json", kWave);
  const auto error = [&](std::vector<std::string> more, int status) {
    std::vector<std::string> words{"run", "play", "--poses", folder / "wave.json"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished refused = run(kaz(words));
    EXPECT_EQ(refused.exit_code, status) << refused.err;
    return refused.err;
  };
  const std::string arm = "feetech:" + (folder / "arm");
  EXPECT_NE(error({"--robot", arm}, 2).find("needs --robot-file FILE"), std::string::npos);
  EXPECT_NE(error({"--robot", arm, "--robot-file", kArm}, 3).find("no such port"),
            std::string::npos);
  EXPECT_NE(error({"--robot", arm, "--robot-file", folder / "none.urdf"}, 2).find("none.urdf"),
            std::string::npos);
  EXPECT_NE(error({"--robot", arm + "@12345", "--robot-file", kArm}, 2).find("12345 baud"),
            std::string::npos);

  // A servo of another id is not there.
  for (const char* file : {"so101.urdf", "motor.xml", "sensors.xml"}) {
    const auto from = std::filesystem::path(kArm).parent_path() / file;
    if (std::filesystem::exists(from)) std::filesystem::copy(from, folder / file);
  }
  std::string bus = read_file(std::filesystem::path(kArm).parent_path() / "bus.json");
  const auto at = bus.find("\"id\": 3");
  ASSERT_NE(at, std::string::npos);
  bus.replace(at, 7, "\"id\": 9");
  write_file(folder / "bus.json", bus);
  Process sim(kaz({"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", folder / "arm"}));
  ASSERT_TRUE(sim.wait_for_output("ready", std::chrono::seconds(30)));
  EXPECT_NE(error({"--robot", arm, "--robot-file", folder / "so101.urdf"}, 3)
                .find("servo 9 (elbow_flex) does not answer on"),
            std::string::npos);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(std::chrono::seconds(10)).exit_code, 0);
}

}  // namespace
}  // namespace kaz::test
