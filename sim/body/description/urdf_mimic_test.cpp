// Joints of a URDF that follow another joint: order, chains, limits, and errors by name.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {
namespace {

const char* const kUsualLimit = "<limit lower='-1' upper='1' effort='2' velocity='5'/>";

// A robot of links in a row: `joints` are the contents of the elements <joint>.
std::string robot_of(const std::vector<std::string>& joints) {
  const std::string inertial =
      "<inertial><mass value='1'/><inertia ixx='2e-3' iyy='2e-3' izz='2e-3' ixy='0' ixz='0' "
      "iyz='0'/></inertial>";
  std::string text = "<robot name='r'>\n<link name='l0'>" + inertial + "</link>\n";
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string number = std::to_string(i), next = std::to_string(i + 1);
    text += "<link name='l" + next + "'>" + inertial + "</link>\n<joint name='j" + number + "' " +
            joints[i] + "<parent link='l" + number + "'/><child link='l" + next + "'/></joint>\n";
  }
  return text + "</robot>\n";
}

std::string turning_joint(const std::string& extra, const std::string& limit = kUsualLimit) {
  return "type='revolute'>" + limit + extra;
}

class MimicJoint : public testing::Test {
 protected:
  Result<RobotModel> load(const std::vector<std::string>& joints, const ReadOptions& options = {}) {
    return load_robot(folder_.write("robot.urdf", robot_of(joints)), options);
  }
  std::string error(const std::vector<std::string>& joints) {
    const auto robot = load(joints);
    return robot ? "" : full_text(robot.error());
  }
  const test::Folder folder_;
};

// j0 = 2 j2 + 0.1 and j2 = -0.5 j1 + 0.2, so j0 = -j1 + 0.5.
TEST_F(MimicJoint, ChainsLeadToTheJointWithAMotor) {
  for (const bool body : {true, false}) {
    const auto robot =
        load({turning_joint("<mimic joint='j2' multiplier='2' offset='0.1'/>"), turning_joint(""),
              turning_joint("<mimic joint='j1' multiplier='-0.5' offset='0.2'/>")},
             {.body = body});
    ASSERT_TRUE(robot) << full_text(robot.error());
    EXPECT_EQ(robot->joint_order(), std::vector<std::string>{"j1"});
    EXPECT_EQ(robot->motors(), 1u);
    ASSERT_EQ(robot->joints.size(), 3u);
    EXPECT_EQ(robot->joints[1].name, "j0");
    EXPECT_EQ(robot->joints[2].name, "j2");
    EXPECT_FALSE(robot->joints[0].follows);
    ASSERT_TRUE(robot->joints[1].follows && robot->joints[2].follows);
    EXPECT_EQ(robot->joints[1].follows->joint, 0);
    EXPECT_DOUBLE_EQ(robot->joints[1].follows->ratio, -1);
    EXPECT_DOUBLE_EQ(robot->joints[1].follows->offset, 0.5);
    EXPECT_DOUBLE_EQ(robot->joints[2].follows->ratio, -0.5);
    EXPECT_DOUBLE_EQ(robot->joints[2].follows->offset, 0.2);
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_EQ(robot->links[static_cast<std::size_t>(robot->joints[j].child)].joint,
                static_cast<int>(j));
  }
}

// -1 <= -2 q + 0.5 <= 0.9 means -0.2 <= q <= 0.75.
TEST_F(MimicJoint, LimitsOfTheFollowerBoundTheLeader) {
  const auto robot =
      load({turning_joint(""), turning_joint("<mimic joint='j0' multiplier='-2' offset='0.5'/>",
                                             "<limit lower='-1' upper='0.9' effort='0.5' "
                                             "velocity='4'/>")});
  ASSERT_TRUE(robot) << full_text(robot.error());
  const RobotJoint& leader = robot->joints[0];
  EXPECT_DOUBLE_EQ(leader.lower, -0.2);
  EXPECT_DOUBLE_EQ(leader.upper, 0.75);
  EXPECT_DOUBLE_EQ(leader.velocity, 2);
  EXPECT_DOUBLE_EQ(leader.effort, 1);
  const auto endless = load({turning_joint(""), "type='continuous'><mimic joint='j0'/>"});
  ASSERT_TRUE(endless) << full_text(endless.error());
  EXPECT_EQ(endless->joints[0].lower, -1);
  EXPECT_EQ(endless->joints[0].velocity, 5);
  EXPECT_EQ(endless->joints[1].follows->ratio, 1);
}

TEST_F(MimicJoint, ErrorsNameTheJoint) {
  const auto expect = [this](const std::vector<std::string>& joints, const std::string& part) {
    EXPECT_NE(error(joints).find(part), std::string::npos) << part << "\n" << error(joints);
  };
  expect({turning_joint(""), turning_joint("<mimic joint='arm'/>")},
         ":6: joint `j1` follows joint `arm`, which does not exist; check the spelling");
  expect({turning_joint(""), turning_joint("<mimic/>")}, ":6: <mimic> lacks the attribute `joint`");
  expect({turning_joint(""), "type='fixed'>", turning_joint("<mimic joint='j1'/>")},
         ":8: joint `j2` follows joint `j1`, which does not move");
  expect({turning_joint(""), "type='fixed'><mimic joint='j0'/>"},
         ":6: joint `j1` is fixed but has <mimic>; remove <mimic>");
  expect({turning_joint(""), turning_joint("<mimic joint='j0' multiplier='0'/>")},
         ":6: multiplier of joint `j1` is 0; its magnitude must be 0.001 to 1000");
  expect({turning_joint(""), turning_joint("<mimic joint='j0' multiplier='nan'/>")},
         ":6: attribute `multiplier` of <mimic> is \"nan\", expected a number");
  expect({turning_joint(""), turning_joint("<mimic joint='j0' offset='inf'/>")},
         ":6: attribute `offset` of <mimic> is \"inf\", expected a number");
  expect({turning_joint(""), turning_joint("<mimic joint='j0' factor='2'/>")},
         ":6: attribute `factor` of <mimic> is unknown");
  expect({turning_joint(""), turning_joint("<mimic joint='j2'/>"),
          turning_joint("<mimic joint='j1'/>")},
         ":8: joint `j2` follows itself through <mimic>; one joint of the cycle needs a motor");
  expect({turning_joint("<mimic joint='j0'/>")}, ":4: joint `j0` follows itself through <mimic>");
  expect({turning_joint(""), turning_joint("<mimic joint='j0' multiplier='900'/>"),
          turning_joint("<mimic joint='j1' multiplier='900'/>", "<limit lower='-9' upper='9'/>")},
         "the product of the multipliers from joint `j2` to joint `j0` is out of range");
  expect({turning_joint(""), turning_joint("<mimic joint='j0' offset='3'/>")},
         ":6: the limits of joint `j1` leave no range to joint `j0`, which it follows");
  expect({turning_joint(""), "type='planar'>" + std::string(kUsualLimit) + "<mimic joint='j0'/>"},
         ":6: joint `j1` has type \"planar\"");
}

// A Kaz with a part that follows one of its joints is a Kaz.
TEST_F(MimicJoint, AKazMayHaveFollowers) {
  std::string text = test::read_text(test::kRobot);
  const std::string part =
      "<link name='flap'><inertial><mass value='0.01'/><inertia ixx='1e-5' iyy='1e-5' izz='1e-5' "
      "ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='flap' type='revolute'>"
      "<limit lower='-2' upper='2' effort='1' velocity='9'/><mimic joint='neck_pan'/>"
      "<parent link='trunk'/><child link='flap'/></joint>";
  text.insert(text.rfind("</robot>"), part);
  const auto robot = load_robot(folder_.write("kaz.urdf", text));
  ASSERT_TRUE(robot) << full_text(robot.error());
  EXPECT_TRUE(robot->is_kaz());
  EXPECT_EQ(robot->joints.back().name, "flap");
  // All joints of the board need a motor.
  std::string driven = test::read_text(test::kRobot);
  const std::string axis = "<axis xyz=\"0 0 1\"/>";
  driven.replace(driven.find(axis), axis.size(), axis + "<mimic joint=\"neck_tilt\"/>");
  const auto lacks = load_robot(folder_.write("kaz.urdf", driven));
  ASSERT_FALSE(lacks);
  EXPECT_NE(full_text(lacks.error()).find("robot has no joint `neck_pan`"), std::string::npos);
}

}  // namespace
}  // namespace kaz::sim
