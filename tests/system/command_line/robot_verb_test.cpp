// `kaz robot check`: what it prints of a robot, its errors, and the files that it writes.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;

// An arm of one joint on a base that is fixed to the world, with something that Kaz does not use.
const std::string kArm =
    "<robot name='lamp'>\n<link name='world'/>\n<link name='arm'><inertial><origin xyz='0 0 0.05'/>"
    "<mass value='0.1'/><inertia ixx='1e-4' iyy='1e-4' izz='1e-5'/></inertial><visual><origin "
    "xyz='0 0 0.05'/><geometry><cylinder radius='0.01' length='0.1'/></geometry></visual></link>\n"
    "<joint name='tilt' type='revolute'><parent link='world'/><child link='arm'/><origin xyz='0 0 "
    "0.2'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' velocity='2'/></joint>\n"
    "<transmission name='t'/>\n</robot>\n";

TEST(RobotVerb, PrintsWhatItReadsAndWhatIsMissing) {
  const TemporaryFolder folder;
  write_file(folder / "lamp.urdf", kArm);
  const Finished text = run(kaz({"robot", "check", folder / "lamp.urdf"}));
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const char* part :
       {"lamp: 1 joints, 2 links, 0.100 kg, 0 collision shapes, fixed to the world",
        "tilt                           -1.0000    1.0000         2         1",
        "not used: <transmission>; --verbose lists the lines",
        "simulation with a servo board: missing motor.xml, sensors.xml"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << "\n" << text.out;
  const Finished verbose = run(kaz({"robot", "check", folder / "lamp.urdf", "--verbose"}));
  EXPECT_NE(verbose.out.find("lamp.urdf:5: <transmission> is not used"), std::string::npos)
      << verbose.out;
  EXPECT_EQ(run(kaz({"robot", "check", folder / "lamp.urdf", "--strict"})).exit_code, 2);
  const auto json = parse_json(run(kaz({"robot", "check", folder / "lamp.urdf", "--json"})).out);
  EXPECT_EQ(json["joints"][0]["velocity_rad_s"], 2);
  EXPECT_EQ(json["not_used"][0]["line"], 5);
}

TEST(RobotVerb, WritesFilesWithWhichTheRobotRuns) {
  const TemporaryFolder folder;
  write_file(folder / "lamp.urdf", kArm);
  const Finished written = run(
      kaz({"robot", "check", folder / "lamp.urdf", "--write", "--picture", folder / "lamp.png"}));
  ASSERT_EQ(written.exit_code, 0) << written.err;
  EXPECT_EQ(read_file(folder / "lamp.png").substr(1, 3), "PNG");
  for (const char* name : {"bus.json", "motor.xml", "sensors.xml"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  const Finished stands = run(kaz(
      {"run", "stand", "--robot-file", folder / "lamp.urdf", "--mcu", "native", "--eyes", "none"}));
  EXPECT_EQ(stands.exit_code, 0) << stands.out << stands.err;
  EXPECT_NE(stands.err.find("not used: <transmission>"), std::string::npos) << stands.err;
  // Files that exist stay as they are.
  write_file(folder / "bus.json", "mine");
  EXPECT_EQ(run(kaz({"robot", "check", folder / "lamp.urdf", "--write"})).exit_code, 0);
  EXPECT_EQ(read_file(folder / "bus.json"), "mine");
}

// A joint that follows another joint counts as no joint of the board, and needs no servo.
TEST(RobotVerb, ListsJointsThatFollow) {
  const TemporaryFolder folder;
  std::string text = kArm;
  text.insert(text.rfind("</robot>"),
              "<link name='jaw'><inertial><mass value='0.1'/><inertia ixx='1e-4' iyy='1e-4' "
              "izz='1e-4'/></inertial></link><joint name='jaw' type='revolute'><parent link='arm'/>"
              "<child link='jaw'/><limit lower='-1' upper='2' effort='0' velocity='0'/>"
              "<mimic joint='tilt' multiplier='-2' offset='0.5'/></joint>");
  write_file(folder / "lamp.urdf", text);
  const Finished check = run(kaz({"robot", "check", folder / "lamp.urdf", "--write"}));
  EXPECT_EQ(check.exit_code, 0) << check.err;
  for (const char* part : {"lamp: 1 joints, 3 links", "jaw = -2 * tilt +0.5 rad (no motor)",
                           "tilt                           -0.7500    0.7500"})
    EXPECT_NE(check.out.find(part), std::string::npos) << part << "\n" << check.out;
  EXPECT_EQ(read_file(folder / "bus.json").find("jaw"), std::string::npos);
  const auto json = parse_json(run(kaz({"robot", "check", folder / "lamp.urdf", "--json"})).out);
  EXPECT_TRUE(json["joints"][0]["follows"].is_null());
  EXPECT_EQ(json["joints"][1]["follows"]["joint"], "tilt");
  EXPECT_EQ(json["joints"][1]["follows"]["ratio"], -2);
}

// The file states 2 rad/s for the joint. The board alone would allow 6 rad/s.
TEST(RobotVerb, ARunKeepsTheSpeedLimitOfTheFile) {
  const TemporaryFolder folder;
  write_file(folder / "lamp.urdf", kArm);
  ASSERT_EQ(run(kaz({"robot", "check", folder / "lamp.urdf", "--write"})).exit_code, 0);
  const auto play = [&](const std::string& time_s) {
    write_file(folder / "poses.json",
               R"({"format": "kaz-poses-1", "poses": [
                   {"time_s": 0, "angles_rad": {"tilt": 0}},
                   {"time_s": )" +
                   time_s + R"(, "angles_rad": {"tilt": 0.8}}]})");
    return run(kaz({"run", "play", "--poses", folder / "poses.json", "--robot-file",
                    folder / "lamp.urdf", "--mcu", "native", "--eyes", "none"}));
  };
  const Finished fast = play("0.4");  // at most 3 rad/s
  EXPECT_EQ(fast.exit_code, 2) << fast.out << fast.err;
  EXPECT_NE(fast.err.find("the poses turn tilt too fast (3.0 rad/s at the time 0.20 s); the board "
                          "allows 2.0 rad/s: leave more time between the poses"),
            std::string::npos)
      << fast.err;
  const Finished slow = play("0.8");
  EXPECT_EQ(slow.exit_code, 0) << slow.out << slow.err;
}

TEST(RobotVerb, OtherVerbsListOrRejectWhatKazDoesNotUse) {
  const TemporaryFolder folder;
  const std::string lamp = folder / "lamp.urdf";
  write_file(lamp, kArm);
  ASSERT_EQ(run(kaz({"robot", "check", lamp, "--write"})).exit_code, 0);
  const auto stand = [&](const std::string& option) {
    return run(kaz({"run", "stand", "--robot-file", lamp, "--mcu", "native", "--eyes", "none",
                    "--out", folder / "out", option}));
  };
  const Finished verbose = stand("--verbose");
  EXPECT_EQ(verbose.exit_code, 0) << verbose.err;
  EXPECT_NE(verbose.err.find("lamp.urdf:5: <transmission> is not used"), std::string::npos)
      << verbose.err;
  const Finished strict = stand("--strict");
  EXPECT_EQ(strict.exit_code, 2) << strict.err;
  EXPECT_NE(strict.err.find("lamp.urdf:5: <transmission> is not used, which --strict does not"),
            std::string::npos)
      << strict.err;
  const Finished bus = run(kaz(
      {"sim", "--bus", "feetech", "--robot-file", lamp, "--serial", folder / "port", "--strict"}));
  EXPECT_EQ(bus.exit_code, 2) << bus.err;
}

// A joint of the lamp; the servo board has 18 channels, and permits less than 2 rad in channel 0.
std::string wide_joint(int number) {
  const std::string name = "arm" + std::to_string(number);
  return "<link name='" + name +
         "'><inertial><mass value='0.01'/><inertia ixx='1e-5' iyy='1e-5' izz='1e-5'/></inertial>"
         "</link>\n<joint name='j" +
         std::to_string(number) + "' type='continuous'><parent link='world'/><child link='" + name +
         "'/><axis xyz='0 0 1'/></joint>\n";
}

TEST(RobotVerb, WritesARobotThatTheServoBoardCanDrive) {
  const TemporaryFolder folder;
  std::string wide = "<robot name='lamp'>\n<link name='world'/>\n";
  for (int i = 0; i < 20; ++i) wide += wide_joint(i);
  write_file(folder / "lamp.urdf", wide + "</robot>\n");
  const auto stand = [&](const std::string& file) {
    return run(
        kaz({"run", "stand", "--robot-file", folder / file, "--mcu", "native", "--eyes", "none"}));
  };
  const Finished written = run(kaz({"robot", "check", folder / "lamp.urdf", "--write"}));
  EXPECT_NE(written.out.find("limits that the board permits (20 joints): use lamp.board.urdf"),
            std::string::npos)
      << written.out;
  EXPECT_NE(written.out.find("; fixed: j18, j19\n"), std::string::npos) << written.out;
  EXPECT_EQ(stand("lamp.urdf").exit_code, 2);
  const Finished stands = stand("lamp.board.urdf");
  EXPECT_EQ(stands.exit_code, 0) << stands.out << stands.err;
  const auto board =
      parse_json(run(kaz({"robot", "check", folder / "lamp.board.urdf", "--json"})).out);
  EXPECT_EQ(board["joints"].size(), 18u);
  EXPECT_NEAR(board["joints"][0]["upper_rad"].get<double>(), 1.5708, 1e-3);
  EXPECT_EQ(board["missing"]["simulation with a servo board"], "");
}

TEST(RobotVerb, OptionsOfMeshesNeedARobotFile) {
  for (const char* option : {"--mesh-collision=box", "--skip-missing-meshes"}) {
    const Finished alone = run(kaz({"run", "stand", option}));
    EXPECT_EQ(alone.exit_code, 2) << option;
    EXPECT_NE(alone.err.find("requires --robot-file"), std::string::npos) << alone.err;
  }
}

TEST(RobotVerb, DoesNotReplaceTheRobotByItsPicture) {
  const TemporaryFolder folder;
  write_file(folder / "lamp.urdf", kArm);
  const Finished end =
      run(kaz({"robot", "check", folder / "lamp.urdf", "--picture", folder / "lamp.urdf"}));
  EXPECT_EQ(end.exit_code, 2) << end.out << end.err;
  EXPECT_NE(end.err.find("--picture"), std::string::npos) << end.err;
  EXPECT_EQ(read_file(folder / "lamp.urdf"), kArm);
}

// The same arm in MJCF, with an attribute of MuJoCo 3.
const std::string kMjcfArm =
    "<mujoco model='lamp'>\n<worldbody><body name='arm' pos='0 0 0.2'>\n<joint name='tilt' axis='0 "
    "1 0' "
    "range='-1 1'/><inertial pos='0 0 0.05' mass='0.1' diaginertia='1e-4 1e-4 1e-5'/><geom "
    "type='cylinder' size='0.01 0.05' pos='0 0 0.05'/></body></worldbody>\n<compiler "
    "angle='radian'/><actuator>\n<position joint='tilt' forcerange='-1 1' kv='3'/>\n</actuator>"
    "</mujoco>\n";

TEST(RobotVerb, ReadsMjcfAndWritesItAsUrdf) {
  const TemporaryFolder folder;
  write_file(folder / "lamp.xml", kMjcfArm);
  const Finished text =
      run(kaz({"robot", "check", folder / "lamp.xml", "--urdf", folder / "lamp.urdf", "--write",
               "--picture", folder / "lamp.png"}));
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const char* part :
       {"lamp: 1 joints, 2 links, 0.100 kg, 1 collision shapes, fixed to the world",
        "tilt                           -1.0000    1.0000      none         1",
        "not used: attribute `kv` of <position>; --verbose lists the lines", "URDF: "})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << "\n" << text.out;
  const Finished again = run(kaz({"robot", "check", folder / "lamp.urdf", "--strict"}));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("lamp: 1 joints, 2 links, 0.100 kg, 1 collision"), std::string::npos)
      << again.out;
  const Finished stands = run(kaz(
      {"run", "stand", "--robot-file", folder / "lamp.xml", "--mcu", "native", "--eyes", "none"}));
  EXPECT_EQ(stands.exit_code, 0) << stands.out << stands.err;
}

TEST(RobotVerb, PrintsAllErrorsAtOnce) {
  const TemporaryFolder folder;
  std::string wrong = kArm;
  wrong.replace(wrong.find("<mass value='0.1'/>"), 19, "<mass value='light'/>");
  wrong.replace(wrong.find("upper='1'"), 9, "upper='-2'");
  write_file(folder / "lamp.urdf", wrong);
  const Finished end = run(kaz({"robot", "check", folder / "lamp.urdf"}));
  EXPECT_EQ(end.exit_code, 2);
  EXPECT_NE(end.err.find("lamp.urdf:3: attribute `value` of <mass> is \"light\""),
            std::string::npos)
      << end.err;
  EXPECT_NE(end.err.find("\n  " + (folder / "lamp.urdf:4: lower limit of joint `tilt`")),
            std::string::npos)
      << end.err;
}

}  // namespace
}  // namespace kaz::test
