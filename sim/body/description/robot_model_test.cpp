// Facts of the robot file: what the paper says of the body, and what the servo board can reach.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/robot_model.h"

#include "shared/base/angle.hpp"
#include "sim/body/description/files_testing.h"

namespace kaz::sim {
namespace {

class Kaz : public testing::Test {
 protected:
  void SetUp() override {
    auto robot = load_robot(test::kRobot);
    ASSERT_TRUE(robot) << robot.error().message;
    robot_ = *robot;
  }
  // Where a point of the child link goes, in the root's frame, when the joint turns from zero.
  Eigen::Vector3d moved(const std::string& joint, const Eigen::Vector3d& in_child, double angle) {
    const auto& names = joint_names();
    const auto number =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), joint) - names.begin());
    const RobotJoint& j = robot_.joints[number];
    const Eigen::Isometry3d& at = robot_.links[static_cast<std::size_t>(j.child)].at_zero;
    return at.translation() + Eigen::AngleAxisd(angle, j.axis) * (at.linear() * in_child);
  }
  RobotModel robot_;
};

TEST_F(Kaz, WeighsWhatThePaperSays) {
  EXPECT_NEAR(robot_.mass(), 1.600, 1e-9);
}

TEST_F(Kaz, StandsThirtyFourCentimetresTall) {
  const Eigen::AlignedBox3d box = robot_.extent();
  EXPECT_NEAR(box.sizes().z(), 0.340, 1e-9);
  EXPECT_NEAR(box.min().z(), -0.160, 1e-9);
}

TEST_F(Kaz, HasItsCentreOfMassBetweenHips) {
  // kaz-model: straight, 0.1705 above the sole, computed from the link table.
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const RobotLink& link : robot_.links)
    sum += link.rigid.mass * (link.at_zero * link.rigid.com);
  const Eigen::Vector3d com = sum / robot_.mass();
  EXPECT_NEAR(com.z() + 0.160, 0.1705, 5e-4);
  EXPECT_NEAR(com.y(), 0, 1e-12);
}

TEST_F(Kaz, LooksNoTallerThanItIs) {
  Eigen::AlignedBox3d seen;
  for (const RobotLink& link : robot_.links) {
    for (const Visual& visual : link.rigid.visuals) {
      seen.extend(extent(visual.shape, link.at_zero * visual.in_frame));
    }
  }
  EXPECT_NEAR(seen.max().z(), 0.180, 1e-3);
  EXPECT_NEAR(seen.min().z(), -0.160, 1e-6);
}

TEST_F(Kaz, HidesNothingBeforeItsEyes) {
  const RobotFrame eye = robot_.frames.at("left_eye");
  const RobotLink& head = robot_.links[static_cast<std::size_t>(eye.link)];
  EXPECT_EQ(head.rigid.name, "neck_tilt");
  for (const Visual& visual : head.rigid.visuals) {
    EXPECT_LE(extent(visual.shape, visual.in_frame).max().x(), eye.in_link.translation().x())
        << visual.name;
  }
}

TEST_F(Kaz, HasEyesAsOpticalFrames) {
  const Eigen::Isometry3d left = robot_.frames.at("left_eye").in_link;
  const Eigen::Isometry3d right = robot_.frames.at("right_eye").in_link;
  EXPECT_TRUE((left.linear() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX(), 1e-9));
  EXPECT_TRUE((left.linear() * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY(), 1e-9));
  // The right eye lies 40 mm along +x of the left optical frame.
  EXPECT_TRUE((left.inverse() * right).translation().isApprox(Eigen::Vector3d(0.040, 0, 0), 1e-9));
}

TEST_F(Kaz, TurnsItsJointsTheWayTheTableSays) {
  const Eigen::Vector3d down(0, 0, -0.05), front(0.05, 0, 0);
  for (const char* joint : {"l_sh_pitch", "r_sh_pitch", "l_elbow", "r_elbow", "l_hip_pitch",
                            "r_hip_pitch", "l_knee", "r_knee"}) {
    EXPECT_LT(moved(joint, down, 0.1).x(), moved(joint, down, 0).x()) << joint;
  }
  for (const char* joint : {"l_sh_roll", "r_sh_roll", "l_hip_roll", "r_hip_roll"}) {
    EXPECT_GT(moved(joint, down, 0.1).y(), moved(joint, down, 0).y()) << joint;
  }
  // Hands close with a positive angle: the moving jaws are outside.
  EXPECT_LT(moved("l_hand", down, 0.1).y(), moved("l_hand", down, 0).y());
  EXPECT_GT(moved("r_hand", down, 0.1).y(), moved("r_hand", down, 0).y());
  EXPECT_GT(moved("neck_pan", front, 0.1).y(), 0) << "positive pan looks left";
  EXPECT_LT(moved("neck_tilt", front, 0.1).z(), moved("neck_tilt", front, 0).z())
      << "positive tilt looks down";
  EXPECT_LT(moved("l_ankle_pitch", front, 0.1).z(), moved("l_ankle_pitch", front, 0).z());
}

TEST_F(Kaz, IsMirrored) {
  const auto mirror = [](Eigen::Vector3d v) { return Eigen::Vector3d(v.x(), -v.y(), v.z()); };
  for (const RobotLink& left : robot_.links) {
    if (left.rigid.name.rfind("l_", 0) != 0) continue;
    const RobotFrame right_frame = robot_.frames.at("r_" + left.rigid.name.substr(2));
    const RobotLink& right = robot_.links[static_cast<std::size_t>(right_frame.link)];
    EXPECT_EQ(left.rigid.mass, right.rigid.mass);
    EXPECT_TRUE(left.rigid.com.isApprox(mirror(right.rigid.com))) << left.rigid.name;
    EXPECT_TRUE(left.at_zero.translation().isApprox(mirror(right.at_zero.translation())));
    ASSERT_EQ(left.rigid.collisions.size(), right.rigid.collisions.size());
    ASSERT_EQ(left.rigid.visuals.size(), right.rigid.visuals.size());
    for (std::size_t i = 0; i < left.rigid.visuals.size(); ++i) {
      const auto a = extent(left.rigid.visuals[i].shape, left.rigid.visuals[i].in_frame);
      const auto b = extent(right.rigid.visuals[i].shape, right.rigid.visuals[i].in_frame);
      EXPECT_TRUE(a.center().isApprox(mirror(b.center()), 1e-9)) << left.rigid.visuals[i].name;
      EXPECT_TRUE(a.sizes().isApprox(b.sizes(), 1e-9)) << left.rigid.visuals[i].name;
    }
  }
}

TEST_F(Kaz, KeepsItsLimitsInsideThePotentiometers) {
  constexpr double kHalfWindow = 95 * kDegree;
  const double centres[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) pot_centre / 10.0,
#include "shared/board/joints.def"
#undef KZ_JOINT
  };
  for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
    const double centre = centres[i] * kDegree;
    EXPECT_GE(robot_.joints[i].lower, centre - kHalfWindow + kDegree) << joint_names()[i];
    EXPECT_LE(robot_.joints[i].upper, centre + kHalfWindow - kDegree) << joint_names()[i];
  }
}

TEST_F(Kaz, ListsParentsBeforeChildren) {
  ASSERT_EQ(robot_.links.size(), KZ_JOINTS + 1u);
  EXPECT_EQ(robot_.links[0].rigid.name, "trunk");
  for (std::size_t i = 1; i < robot_.links.size(); ++i) {
    EXPECT_LT(robot_.links[i].parent, static_cast<int>(i));
  }
}

TEST(Weld, AddsInertiaByTheParallelAxisTheorem) {
  // Two equal uniform cubes of side 0.1 side by side are a box of 0.2 x 0.1 x 0.1.
  RigidLink cube;
  cube.mass = 1;
  cube.inertia = Eigen::Matrix3d::Identity() * (0.02 / 12);
  RigidLink pair = cube;
  weld(pair, cube, Eigen::Isometry3d(Eigen::Translation3d(0.1, 0, 0)));
  EXPECT_DOUBLE_EQ(pair.mass, 2);
  EXPECT_TRUE(pair.com.isApprox(Eigen::Vector3d(0.05, 0, 0)));
  EXPECT_NEAR(pair.inertia(0, 0), 2 * 0.02 / 12, 1e-12);
  EXPECT_NEAR(pair.inertia(1, 1), 2 * 0.05 / 12, 1e-12);
}

}  // namespace
}  // namespace kaz::sim
