// Robots of others in MJCF: several joints of a body, tendons, mocap bodies, fitted shapes.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {
namespace {

const char* const kHeavy = "<inertial pos='0 0 0' mass='1' diaginertia='2e-3 2e-3 2e-3'/>";

class FieldMjcf : public testing::Test {
 protected:
  Result<RobotModel> load(const std::string& bodies, const std::string& more = {}) {
    return load_robot(folder_.write("robot.xml", "<mujoco><worldbody>\n" + bodies +
                                                     "\n</worldbody>\n" + more + "</mujoco>"));
  }
  RobotModel accepted(const std::string& bodies, const std::string& more = {}) {
    auto read = load(bodies, more);
    EXPECT_TRUE(read) << full_text(read.error());
    return read ? *read : RobotModel();
  }
  void expect_refused(const std::string& bodies, const std::string& more, const std::string& part) {
    const auto read = load(bodies, more);
    ASSERT_FALSE(read);
    EXPECT_NE(full_text(read.error()).find(part), std::string::npos) << full_text(read.error());
  }
  const test::Folder folder_;
};

std::string finger_text(const std::string& name) {
  return "<body name='" + name + "'>" + kHeavy + "<joint name='" + name +
         "_joint' type='slide' range='0 0.04'/></body>";
}

TEST_F(FieldMjcf, JointsOfOneBodyActInTheirOrder) {
  const RobotModel model = accepted(
      std::string("<body name='base' pos='0 0 1'>") + kHeavy +
      "<joint name='x' type='slide' axis='1 0 0'/><joint name='turn' axis='0 0 1' pos='0.1 0 0'/>"
      "<joint name='lift' axis='0 1 0'/></body>");
  ASSERT_EQ(model.links.size(), 4u);
  EXPECT_EQ(model.mass(), 1);
  EXPECT_EQ(model.links[3].rigid.name, "base");
  for (int i = 1; i < 4; ++i) EXPECT_EQ(model.links[static_cast<std::size_t>(i)].parent, i - 1);
  EXPECT_EQ(model.joints[0].name, "x");
  EXPECT_EQ(model.joints[1].name, "turn");
  EXPECT_EQ(model.joints[2].name, "lift");
  const Eigen::Vector3d at_joint = model.links[2].at_zero.translation();
  EXPECT_TRUE(at_joint.isApprox(Eigen::Vector3d(0.1, 0, 1))) << at_joint.transpose();
  EXPECT_TRUE(model.links[3].at_zero.translation().isApprox(Eigen::Vector3d(0, 0, 1)));
}

TEST_F(FieldMjcf, TendonDividesTheForceOfItsActuator) {
  const std::string tendon =
      "<tendon><fixed name='split'><joint joint='a_joint' coef='0.5'/>"
      "<joint joint='b_joint' coef='-0.25'/></fixed></tendon><actuator><position tendon='split' "
      "forcerange='-80 100'/></actuator>";
  const std::string fingers = finger_text("a") + finger_text("b");
  const RobotModel two = accepted(fingers, tendon);
  ASSERT_EQ(two.motors(), 2u);
  const double pinion = two.joints[0].pinion_m;
  EXPECT_DOUBLE_EQ(two.joints[0].effort, 50 * pinion);
  EXPECT_DOUBLE_EQ(two.joints[1].effort, 25 * pinion);
  const RobotModel one = accepted(
      fingers, tendon + "<equality><joint joint1='b_joint' joint2='a_joint'/></equality>");
  ASSERT_EQ(one.motors(), 1u);
  EXPECT_DOUBLE_EQ(one.joints[0].effort, 75 * pinion) << "the follower's part, too";
}

TEST_F(FieldMjcf, TendonsThatActByThemselvesAreRefused) {
  const std::string part = "<joint joint='a_joint' coef='1'/></fixed></tendon>";
  expect_refused(finger_text("a"), "<tendon><fixed stiffness='3'>" + part,
                 ":4: attribute `stiffness` of <fixed> is not supported");
  expect_refused(finger_text("a"), "<default><tendon damping='3'/></default><tendon><fixed>" + part,
                 "attribute `damping` of <tendon> is not supported: Kaz's tendons");
}

TEST_F(FieldMjcf, MocapBodiesAndTheirTiesAreNoted) {
  const RobotModel model = accepted(
      "<body name='hand' mocap='true'><geom size='0.1'/></body>" + finger_text("a"),
      "<equality><weld body1='hand' body2='a'/></equality>");
  EXPECT_EQ(summary(model.notes), "body `hand` (mocap), <weld> (mocap)");
  EXPECT_TRUE(model.links[0].rigid.collisions.empty());
}

TEST_F(FieldMjcf, ShapesAreFittedToTheirMesh) {
  folder_.write("slab.obj",
                "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 2 1 0\nv 0 0 4\nv 2 0 4\nv 0 1 4\nv 2 1 4\n"
                "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\n"
                "f 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n");
  const std::string arm = std::string("<body name='arm'>") + kHeavy +
                          "<joint name='j'/><geom type='box' mesh='slab'/></body>";
  const RobotModel model = accepted(arm, "<asset><mesh file='slab.obj'/></asset>");
  const CollisionShape& box = model.links[1].rigid.collisions.at(0);
  EXPECT_EQ(box.shape.kind, Shape::Kind::box);
  EXPECT_NEAR(box.shape.size.prod(), 8, 1e-6);
  EXPECT_TRUE(box.in_link.translation().isApprox(Eigen::Vector3d(1, 0.5, 2), 1e-6));
  expect_refused(arm, "", ":2: <geom> refers to mesh `slab`, which does not exist");
}

}  // namespace
}  // namespace kaz::sim
