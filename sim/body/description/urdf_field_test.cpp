// Robots of others in URDF: what exporters and other simulators write.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {
namespace {

const char* const kOneKilogram =
    "<inertial><mass value='1'/><inertia ixx='2e-3' iyy='2e-3' izz='2e-3'/></inertial>";

// A chain of three links, with additions.
struct FieldRobot {
  std::string base = kOneKilogram, middle = kOneKilogram, tip = kOneKilogram, start,
              limit = "<limit lower='-1' upper='1' effort='1' velocity='1'/>", more;
  static std::string joint(const std::string& name, const std::string& from, const std::string& to,
                           const std::string& axis, const std::string& parts) {
    return "<joint name='" + name + "' type='revolute'><parent link='" + from + "'/><child link='" +
           to + "'/><axis xyz='" + axis + "'/>" + parts + "</joint>";
  }
  std::string text() const {
    return start + "<robot name='r'><link name='base'>" + base + "</link><link name='middle'>" +
           middle + "</link><link name='tip'>" + tip + "</link>" +
           joint("first", "base", "middle", "1 0 0", limit) +
           joint("second", "middle", "tip", "0 1 0", limit) + more + "</robot>";
  }
};

class FieldUrdf : public testing::Test {
 protected:
  Result<RobotModel> load(const FieldRobot& robot) {
    return load_robot(folder_.write("robot.urdf", robot.text()));
  }
  RobotModel accepted(const FieldRobot& robot) {
    auto read = load(robot);
    EXPECT_TRUE(read) << full_text(read.error());
    return read ? *read : RobotModel();
  }
  void expect_refused(const FieldRobot& robot, const std::string& part) {
    const auto read = load(robot);
    ASSERT_FALSE(read);
    EXPECT_NE(full_text(read.error()).find(part), std::string::npos) << full_text(read.error());
  }
  const test::Folder folder_;
};

TEST_F(FieldUrdf, XmlDeclarationMayFollowComments) {
  FieldRobot robot;
  robot.start = "<!-- made by xacro -->\n<!-- twice -->\n<?xml version='1.0'?>\n";
  EXPECT_EQ(accepted(robot).joints.size(), 2u);
  robot.more = "<lnk/>";
  expect_refused(robot, "robot.urdf:4: unknown element <lnk>");
}

TEST_F(FieldUrdf, InertiaNearThePhysicalLimitIsNoted) {
  FieldRobot robot;
  robot.tip = "<inertial><mass value='1'/><inertia ixx='3e-3' iyy='1e-3' izz='1.7e-3' iyx='0'/>"
              "</inertial>";
  EXPECT_EQ(summary(accepted(robot).notes),
            "attribute `iyx` of <inertia>, rule of the principal moments in link `tip` (one "
            "exceeds the sum of the others)");
  EXPECT_EQ(accepted(robot).links[2].rigid.inertia(0, 0), 3e-3) << "used as stated";
  robot.tip = "<inertial><mass value='1'/><inertia ixx='5e-3' iyy='1e-3' izz='1.7e-3'/></inertial>";
  expect_refused(robot, "the inertia of link `tip` is impossible");
}

TEST_F(FieldUrdf, LinkWithoutMassMayCarryOthers) {
  FieldRobot robot;
  robot.middle = "";
  const RobotModel model = accepted(robot);
  ASSERT_EQ(model.links.size(), 3u);
  EXPECT_EQ(model.mass(), 2);
  robot.tip = "";
  expect_refused(robot, "link `middle` moves but has no mass");
}

TEST_F(FieldUrdf, EqualAndHugeLimits) {
  FieldRobot robot;
  robot.limit = "<limit effort='1' velocity='1'/>";
  const RobotModel locked = accepted(robot);
  EXPECT_EQ(locked.joints[0].lower, 0);
  EXPECT_EQ(locked.joints[0].upper, 0);
  EXPECT_EQ(locked.notes.at(0).what, "range of joint `first` (its limits are equal)");
  robot.limit = "<limit lower='-1e16' upper='1e16' effort='1' velocity='1' k_velocity='1'/>";
  const RobotModel free = accepted(robot);
  EXPECT_EQ(free.joints[1].lower, -HUGE_VAL);
  EXPECT_EQ(free.joints[1].upper, HUGE_VAL);
  robot.limit = "<limit lower='-180' upper='180'/>";
  expect_refused(robot, "lower limit of joint `first` is -180 rad");
}

TEST_F(FieldUrdf, FloatingJointOfAnEmptyRootFreesTheRobot) {
  FieldRobot robot;
  robot.more = "<link name='world'/><joint name='free' type='floating'><parent link='world'/>"
               "<child link='base'/></joint>";
  const RobotModel model = accepted(robot);
  EXPECT_FALSE(model.fixed_base);
  EXPECT_EQ(model.links[0].rigid.name, "base");
  EXPECT_EQ(summary(model.notes), "floating joint (the robot is free)");
  robot.more = "<link name='ball'>" + std::string(kOneKilogram) +
               "</link><joint name='free' type='floating'><parent link='tip'/><child link='ball'/>"
               "</joint>";
  expect_refused(robot, "joint `free` is floating, which is supported only");
}

TEST_F(FieldUrdf, ShapesWithoutASizeAreLeftOut) {
  FieldRobot robot;
  robot.tip += "<visual><geometry><cylinder radius='0.1' length='0'/></geometry><material name='x'>"
               "<color rgba='1 0 0'/></material></visual><collision><geometry><box size='0 0 0'/>"
               "</geometry></collision>";
  const RobotModel model = accepted(robot);
  EXPECT_TRUE(model.links[2].rigid.visuals.empty());
  EXPECT_TRUE(model.links[2].rigid.collisions.empty());
  EXPECT_EQ(summary(model.notes),
            "<cylinder> without a size, attribute `rgba` of <color>, <box> without a size");
  robot.tip = kOneKilogram + std::string("<collision><geometry><box size='1 1 0'/></geometry>"
                                         "</collision>");
  expect_refused(robot, "<box> has a size of 0 m");
}

TEST_F(FieldUrdf, MeshesThatCannotBeReadAreOnlyNeededForCollisions) {
  folder_.write("look.glb", "glTF");
  FieldRobot robot;
  robot.tip += "<visual><geometry><mesh filename='look.glb'/></geometry></visual>";
  const RobotModel model = accepted(robot);
  EXPECT_TRUE(model.links[2].rigid.visuals.empty());
  EXPECT_EQ(summary(model.notes), "mesh `look.glb` (it is not .obj, .stl or .dae)");
  robot.tip += "<collision><geometry><mesh filename='look.glb'/></geometry></collision>";
  expect_refused(robot, "mesh `look.glb` is not .obj, .stl or .dae");
}

TEST_F(FieldUrdf, FrictionOfPyBulletAndOldGazebo) {
  FieldRobot robot;
  const std::string ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
  robot.middle += ball + "<contact><lateral_friction value='0.3'/><inertia_scaling value='3'/>"
                         "<contact_cfm value='0'/></contact>";
  robot.tip += ball;
  robot.more = "<gazebo reference='tip'><mu1 value='100'/><mu2 value='50'/></gazebo>";
  const RobotModel model = accepted(robot);
  EXPECT_EQ(model.links[1].rigid.collisions.at(0).surface.mu, 0.3);
  EXPECT_DOUBLE_EQ(model.links[1].rigid.inertia(0, 0), 6e-3);
  EXPECT_EQ(model.links[2].rigid.collisions.at(0).surface.mu, 50);
  robot.more = "<gazebo reference='tip'><mu1>1.5</mu1><mu2>0.5</mu2></gazebo>";
  expect_refused(robot, "mu1 and mu2 must be equal");
  robot.more = "";
  robot.tip += "<contact><lateral_friction value='-1'/></contact>";
  expect_refused(robot, "<lateral_friction> must have a `value` not below 0");
}

}  // namespace
}  // namespace kaz::sim
