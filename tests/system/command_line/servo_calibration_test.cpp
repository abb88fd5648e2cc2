// `kaz calibrate joints` on a bus: joints turned by hand, offsets against the wrap of positions, bus.json.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/control_socket_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

const std::string kArm = std::string(KAZ_TREE) + "/sim/robots/so101";

// The arm as somebody has screwed it together, and the file that its owner has of it.
class AssembledArm {
 public:
  // `zeros`: steps of the encoders at the joints' angle 0.
  explicit AssembledArm(const std::map<std::string, int>& zeros) {
    for (const char* copy : {"real", "mine"})
      std::filesystem::copy(kArm, folder_ / copy, std::filesystem::copy_options::recursive);
    auto bus = json::parse(std::ifstream(folder_ / "real/bus.json"));
    for (auto& servo : bus["servos"])
      if (zeros.contains(servo["joint"])) servo["zero"] = zeros.at(servo["joint"]);
    std::ofstream(folder_ / "real/bus.json") << bus.dump(1);
    sim_.emplace(kaz({"sim", "--bus", "feetech", "--robot-file", folder_ / "real/so101.urdf",
                      "--serial", port(), "--suspended"}));
    EXPECT_TRUE(sim_->wait_for_output("ready", seconds(30))) << sim_->wait(seconds(0)).err;
  }
  std::string port() const { return folder_ / "arm"; }
  std::string mine() const { return folder_ / "mine/so101.urdf"; }
  std::string file() const { return read_file(folder_ / "mine/bus.json"); }
  std::string out() const { return folder_ / "out"; }
  std::vector<std::string> calibrate(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"calibrate",         "joints",       "--robot",
                                   "feetech:" + port(), "--robot-file", mine()};
    words.insert(words.end(), more.begin(), more.end());
    return kaz(words);
  }
  void control(const std::string& line) const {
    EXPECT_NE(query_control(port() + ".ctl", line).find("\"ok\":true"), std::string::npos) << line;
  }
  json servos() const { return parse_json(query_control(port() + ".ctl", "status"))["servos"]; }
  void turn(std::vector<std::string> joints, int degrees, int ms) const {
    for (const std::string& joint : joints)
      control("turn " + joint + " " + std::to_string(degrees));
    std::this_thread::sleep_for(milliseconds(ms));
  }
  // From one stop to the other: past them, where the hand presses. Others are where they are not in the way.
  void turn_pan() const {
    turn({"shoulder_pan"}, -190, 1700);
    turn({"shoulder_pan"}, 190, 2000);
  }
  void turn_all() const {
    turn({"shoulder_lift", "elbow_flex", "wrist_flex"}, 0, 800);
    const std::vector<std::string> free{"shoulder_pan", "wrist_roll", "gripper"};
    for (const auto& [degrees, ms] : {std::pair(-190, 1700), {190, 2200}, {0, 1000}})
      turn(free, degrees, ms);
    turn({"elbow_flex"}, -90, 900);
    for (const auto& [degrees, ms] : {std::pair(-190, 1200), {190, 1800}, {-90, 1200}})
      turn({"shoulder_lift"}, degrees, ms);
    for (const auto& [degrees, ms] : {std::pair(190, 1900), {-190, 1900}})
      turn({"elbow_flex"}, degrees, ms);
    turn({"shoulder_lift", "elbow_flex"}, 0, 1000);
    for (const auto& [degrees, ms] : {std::pair(-190, 1200), {190, 1900}})
      turn({"wrist_flex"}, degrees, ms);
  }

 private:
  TemporaryFolder folder_;
  std::optional<Process> sim_;
};

TEST(ServoCalibration, RangesThatWrapArePlacedAndTheArmPlaysAsItsFileSays) {
  const AssembledArm arm({{"shoulder_pan", 300}, {"elbow_flex", 4000}, {"wrist_roll", 0}});
  Process run_it(arm.calibrate({"--yes", "--seconds", "60", "--out", arm.out(), "--json"}));
  std::this_thread::sleep_for(milliseconds(700));
  arm.turn_all();
  const Finished done = run_it.wait(seconds(60));
  ASSERT_EQ(done.exit_code, 0) << done.out << done.err;
  arm.control("turn off");
  const json result = parse_json(done.out);
  EXPECT_EQ(result["stored"], true);
  ASSERT_EQ(result["joints"].size(), 6u);
  EXPECT_EQ(parse_json(read_file(arm.out() + "/result.json"))["joints"], result["joints"]);
  const json mine = parse_json(arm.file());
  const json servos = arm.servos();
  for (std::size_t j = 0; j < 6; ++j) {
    const json& one = result["joints"][j];
    SCOPED_TRACE(one.dump());
    const json& servo = servos[j];
    const bool wraps = one["joint"] == "shoulder_pan" || one["joint"] == "elbow_flex" ||
                       one["joint"] == "wrist_roll";
    EXPECT_EQ(one["wrapped"], wraps);
    EXPECT_EQ(servo["offset"] != 0, wraps);
    EXPECT_GE(one["steps"][0], 40);
    EXPECT_LE(one["steps"][1], 4055);
    EXPECT_LE(servo["min_angle"], one["steps"][0]);
    EXPECT_GE(servo["max_angle"], one["steps"][1]);
    // With the file's zero the position is the angle: 1 degree, the stops give way.
    const double steps = servo["position"].get<double>() - mine["servos"][j]["zero"].get<double>();
    EXPECT_NEAR(steps * 360 / 4096, servo["angle_deg"].get<double>(), 1.0);
    EXPECT_EQ(servo["torque"], 0);
  }
  // The offsets stay without power.
  arm.control("power off");
  arm.control("power on");
  for (std::size_t j = 0; j < 6; ++j) EXPECT_EQ(arm.servos()[j]["offset"], servos[j]["offset"]);
  // Once more: nothing is left to write to EEPROM.
  Process again(arm.calibrate({"--no-store", "--json"}));
  std::this_thread::sleep_for(milliseconds(700));
  arm.turn_all();
  const Finished same = again.wait(seconds(40));
  EXPECT_EQ(same.exit_code, 0) << same.err;
  const json second = parse_json(same.out);
  ASSERT_EQ(second["joints"].size(), 6u);
  for (const auto& one : second["joints"]) {
    EXPECT_EQ(one["eeprom"], json::object()) << one;
    EXPECT_EQ(one["wrapped"], false) << one;
  }
}

TEST(ServoCalibration, NothingIsWrittenWithoutAGoodRangeOrAfterCtrlC) {
  const AssembledArm arm({{"shoulder_pan", 300}});
  const std::string before = arm.file();
  const json servos = arm.servos();
  const auto unchanged = [&] {
    EXPECT_EQ(arm.file(), before);
    const json now = arm.servos();
    for (std::size_t j = 0; j < 6; ++j) {
      for (const char* what : {"offset", "min_angle", "max_angle", "torque"})
        EXPECT_EQ(now[j][what], servos[j][what]) << what << j;
    }
  };
  // One joint alone was turned.
  Process some(arm.calibrate({"--yes", "--seconds", "6"}));
  std::this_thread::sleep_for(milliseconds(700));
  arm.turn_pan();
  const Finished missing = some.wait(seconds(30));
  EXPECT_EQ(missing.exit_code, 1) << missing.out << missing.err;
  EXPECT_NE(missing.out.find("gripper: the joint was turned through "), std::string::npos)
      << missing.out;
  unchanged();
  // Ctrl-C on the way.
  Process broken(arm.calibrate({"--yes"}));
  std::this_thread::sleep_for(seconds(1));
  broken.signal(SIGINT);
  EXPECT_EQ(broken.wait(seconds(5)).exit_code, 128 + SIGINT);
  unchanged();
  // Nobody at the keyboard, and no --yes.
  Process nobody(arm.calibrate());
  std::this_thread::sleep_for(milliseconds(700));
  arm.turn_all();
  const Finished refused = nobody.wait(seconds(40));
  EXPECT_EQ(refused.exit_code, 2) << refused.out << refused.err;
  EXPECT_NE(refused.err.find("nothing was written"), std::string::npos) << refused.err;
  EXPECT_NE(refused.out.find("position_offset"), std::string::npos) << refused.out;
  unchanged();
}

TEST(ServoCalibration, WhatIsWrongIsNamed) {
  const AssembledArm arm({});
  const auto error = [&](std::vector<std::string> words, int status) {
    const Finished refused = run(kaz(words), seconds(30));
    EXPECT_EQ(refused.exit_code, status) << refused.out << refused.err;
    return refused.err;
  };
  const std::string robot = "feetech:" + arm.port();
  EXPECT_NE(error({"calibrate", "joints", "--robot", robot}, 2).find("needs --robot-file"),
            std::string::npos);
  EXPECT_NE(error({"calibrate", "joints", "--robot", robot, "--robot-file", arm.mine(), "--only",
                   "stops"},
                  2)
                .find("--only is for a robot with a servo board"),
            std::string::npos);
  EXPECT_NE(error({"calibrate", "joints", "--seconds", "5"}, 2).find("on a servo bus"),
            std::string::npos);
  // Somebody else drives it.
  // A servo that a program has left holding.
  const std::string torque_on =
      "import os, sys, termios, time, tty\n"
      "port = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)\n"
      "tty.setraw(port)\n"
      "line = termios.tcgetattr(port)\n"
      "line[4] = line[5] = termios.B1000000\n"
      "termios.tcsetattr(port, termios.TCSANOW, line)\n"
      "os.write(port, bytes([255, 255, 2, 4, 3, 40, 1, 205]))\n"
      "time.sleep(0.3)\n";
  EXPECT_EQ(run({KAZ_PYTHON, "-c", torque_on, arm.port()}).exit_code, 0);
  ASSERT_EQ(arm.servos()[1]["torque"], 1);
  std::vector<std::string> words{"calibrate",    "joints",   "--robot",   robot,
                                 "--robot-file", arm.mine(), "--seconds", "1"};
  EXPECT_NE(error(words, 3).find("servo 2 (shoulder_lift) on"), std::string::npos);
  EXPECT_EQ(arm.servos()[1]["torque"], 1);
  words.push_back("--release");
  EXPECT_NE(error(words, 1).find("nothing is written"), std::string::npos);
  EXPECT_EQ(arm.servos()[1]["torque"], 0);
}

}  // namespace
}  // namespace kaz::test
