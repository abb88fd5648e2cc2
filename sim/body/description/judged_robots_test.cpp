// Our URDF reader against urdfdom and KDL: mass, center of mass, joints, limits, and the pose of each link.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/posture_testing.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {
namespace {

constexpr double kAgrees = 1e-9;  // m, kg, rad

Eigen::Isometry3d from_kdl(const KDL::Frame& frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    pose.translation()[r] = frame.p(r);
    for (int c = 0; c < 3; ++c) pose.linear()(r, c) = frame.M(r, c);
  }
  return pose;
}

// Angles within the limits, different for each posture.
std::vector<double> posture(const RobotModel& robot, int number) {
  std::vector<double> angles;
  for (const RobotJoint& joint : robot.joints) {
    const double low = std::max(joint.lower, -3.0), high = std::min(joint.upper, 3.0);
    const double share =
        std::fmod(0.37 + 0.618 * static_cast<double>(angles.size() + 1) * number, 1.0);
    angles.push_back(number == 0 ? 0 : low + share * (high - low));
  }
  return angles;
}

void judge_robot(const std::string& path) {
  const auto robot = load_robot(path, {.skip_missing_meshes = true});
  ASSERT_TRUE(robot) << full_text(robot.error());
  const auto model = urdf::parseURDFFile(path);
  ASSERT_TRUE(model);
  KDL::Tree tree;
  ASSERT_TRUE(kdl_parser::treeFromFile(path, tree));

  EXPECT_EQ(robot->joints.size(), tree.getNrOfJoints());
  for (const RobotJoint& joint : robot->joints) {
    const auto other = model->getJoint(joint.name);
    ASSERT_TRUE(other) << joint.name;
    const double unit = test::unit_of(joint);
    EXPECT_EQ(joint.pinion_m > 0, other->type == urdf::Joint::PRISMATIC) << joint.name;
    if (other->type == urdf::Joint::CONTINUOUS) {
      EXPECT_TRUE(std::isinf(joint.lower) && std::isinf(joint.upper)) << joint.name;
    } else {
      EXPECT_NEAR(joint.lower * unit, other->limits->lower, kAgrees) << joint.name;
      EXPECT_NEAR(joint.upper * unit, other->limits->upper, kAgrees) << joint.name;
    }
    if (other->limits && other->limits->effort > 0) {
      EXPECT_NEAR(joint.effort / unit, other->limits->effort, kAgrees) << joint.name;
    }
    if (other->limits && other->limits->velocity > 0) {
      EXPECT_NEAR(joint.velocity * unit, other->limits->velocity, kAgrees) << joint.name;
    }
    if (other->dynamics) {
      EXPECT_NEAR(joint.damping / (unit * unit), other->dynamics->damping, kAgrees) << joint.name;
      EXPECT_NEAR(joint.friction / unit, other->dynamics->friction, kAgrees) << joint.name;
    }
  }

  KDL::TreeFkSolverPos_recursive kinematics(tree);
  for (int number = 0; number < 3; ++number) {
    const std::vector<double> angles = posture(*robot, number);
    KDL::JntArray q(tree.getNrOfJoints());
    for (const auto& [name, segment] : tree.getSegments()) {
      const std::string& joint = segment.segment.getJoint().getName();
      for (std::size_t j = 0; j < angles.size(); ++j)
        if (robot->joints[j].name == joint)
          q(segment.q_nr) = test::unit_of(robot->joints[j]) * angles[j];
    }
    const auto poses = test::link_poses(*robot, angles);
    double mass = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& [name, link] : model->links_) {
      KDL::Frame frame;
      if (name != model->getRoot()->name) {
        ASSERT_GE(kinematics.JntToCart(q, frame, name), 0) << name;
      }
      const Eigen::Isometry3d theirs = from_kdl(frame);
      const RobotFrame& at = robot->frames.at(name);
      const Eigen::Isometry3d ours = poses[static_cast<std::size_t>(at.link)] * at.in_link;
      EXPECT_LT((ours.matrix() - theirs.matrix()).cwiseAbs().maxCoeff(), kAgrees)
          << name << " in posture " << number;
      if (!link->inertial) continue;
      const urdf::Vector3& com = link->inertial->origin.position;
      mass += link->inertial->mass;
      sum += link->inertial->mass * (theirs * Eigen::Vector3d(com.x, com.y, com.z));
    }
    Eigen::Vector3d own = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < poses.size(); ++i)
      own += robot->links[i].rigid.mass * (poses[i] * robot->links[i].rigid.com);
    EXPECT_NEAR(robot->mass(), mass, kAgrees);
    EXPECT_LT((own - sum).norm(), kAgrees * mass) << "center of mass in posture " << number;
  }
}

class JudgedRobot : public testing::TestWithParam<std::string> {};

TEST_P(JudgedRobot, AgreesWithUrdfdomAndKdl) {
  judge_robot(GetParam());
}

TEST(JudgedGripper, AgreesWithUrdfdomAndKdl) {
  const std::string mass =
      "<inertial><origin xyz='0 0.01 0.02'/><mass value='0.1'/><inertia ixx='1e-4' iyy='1e-4' "
      "izz='1e-4' ixy='0' ixz='0' iyz='0'/></inertial></link>";
  const test::Folder folder;
  judge_robot(folder.write(
      "gripper.urdf",
      "<robot name='gripper'><link name='world'/><link name='hand'>" + mass + "<link name='left'>" +
          mass + "<link name='right'>" + mass +
          "<joint name='wrist' type='revolute'><parent link='world'/><child link='hand'/>"
          "<origin xyz='0 0 0.3' rpy='0.2 0.1 0'/><axis xyz='0 0 1'/>"
          "<limit lower='-1' upper='1' effort='2' velocity='3'/></joint>"
          "<joint name='open' type='prismatic'><parent link='hand'/><child link='left'/>"
          "<origin xyz='0 0.01 0.1' rpy='0.3 0 0.5'/><axis xyz='0 3 4'/>"
          "<limit lower='-0.01' upper='0.04' effort='20' velocity='0.2'/>"
          "<dynamics damping='5' friction='0.3'/></joint>"
          "<joint name='close' type='prismatic'><parent link='hand'/><child link='right'/>"
          "<origin xyz='0 -0.01 0.1'/><axis xyz='0 -1 0'/>"
          "<limit lower='-0.01' upper='0.05' effort='20' velocity='0.2'/></joint></robot>"));
}

INSTANTIATE_TEST_SUITE_P(Files, JudgedRobot, testing::ValuesIn(test::robot_files()),
                         test::robot_test_name);

}  // namespace
}  // namespace kaz::sim
