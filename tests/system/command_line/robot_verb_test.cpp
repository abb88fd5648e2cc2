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
