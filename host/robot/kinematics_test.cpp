// Kinematics against the robot's description, and the gaze against the kinematics.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/kinematics.h"

#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

#include "shared/base/angle.hpp"

namespace kaz::host {
namespace {

// The pose of a link in the trunk's frame, straight from the URDF.
Eigen::Isometry3d pose_in_urdf(const std::string& link, const JointAngles& angle) {
  static const urdf::ModelInterfaceSharedPtr model =
      urdf::parseURDFFile("shared/robot/kaz/kaz.urdf");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (auto at = model->getLink(link); at->parent_joint; at = at->getParent()) {
    const urdf::Joint& joint = *at->parent_joint;
    const urdf::Pose& origin = joint.parent_to_joint_origin_transform;
    double x, y, z, w;
    origin.rotation.getQuaternion(x, y, z, w);
    Eigen::Isometry3d step =
        Eigen::Translation3d(origin.position.x, origin.position.y, origin.position.z) *
        Eigen::Quaterniond(w, x, y, z);
    if (const auto number = joint_index(joint.name)) {
      step = step * Eigen::AngleAxisd(angle[static_cast<std::size_t>(*number)],
                                      Eigen::Vector3d(joint.axis.x, joint.axis.y, joint.axis.z));
    }
    pose = step * pose;
  }
  return pose;
}

JointAngles some_angles(int n) {
  JointAngles angle;
  for (std::size_t j = 0; j < angle.size(); ++j) {
    const JointInfo& info = joint_table()[j];
    const double share = std::fmod(0.37 + 0.618 * static_cast<double>(j + 1) * n, 1.0);
    angle[j] = info.lower_rad + share * (info.upper_rad - info.lower_rad);
  }
  return angle;
}

TEST(Kinematics, JointTableIsTheUrdfs) {
  const auto model = urdf::parseURDFFile("shared/robot/kaz/kaz.urdf");
  for (const JointInfo& info : joint_table()) {
    const auto joint = model->getJoint(info.name);
    ASSERT_TRUE(joint) << info.name;
    EXPECT_NEAR(info.lower_rad, joint->limits->lower, 5e-5) << info.name;
    EXPECT_NEAR(info.upper_rad, joint->limits->upper, 5e-5) << info.name;
  }
  EXPECT_EQ(joint_index("neck_tilt"), neck_tilt);
  EXPECT_FALSE(joint_index("tail"));
}

TEST(Kinematics, EyesAndFeetStandWhereTheUrdfSays) {
  for (int n = 1; n <= 20; ++n) {
    const JointAngles angle = some_angles(n);
    EXPECT_TRUE(trunk_from_eye(angle).isApprox(pose_in_urdf("left_eye", angle), 1e-5)) << n;
    EXPECT_TRUE(trunk_from_eye(angle, Side::right).isApprox(pose_in_urdf("right_eye", angle), 1e-5))
        << n;
    const Eigen::Translation3d sole(0, 0, -0.030);
    EXPECT_TRUE(trunk_from_sole(angle, Side::left)
                    .isApprox(pose_in_urdf("l_ankle_pitch", angle) * sole, 1e-5));
    EXPECT_TRUE(trunk_from_sole(angle, Side::right)
                    .isApprox(pose_in_urdf("r_ankle_pitch", angle) * sole, 1e-5));
  }
}

// Standing straight: hips 0.160 above the sole, neck 0.118 and 0.018 above them, lens 0.022 above
// that.
TEST(Kinematics, EyeAboveTheFoot) {
  const Eigen::Isometry3d pose = foot_from_eye(JointAngles{});
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(0.030, 0.020 - 0.033, 0.318), 1e-9))
      << pose.translation().transpose();
  EXPECT_TRUE((pose.linear() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX(), 1e-9));
  EXPECT_TRUE((pose.linear() * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ(), 1e-9));
}

TEST(Kinematics, TheLowerFootSupports) {
  JointAngles angle{};
  EXPECT_EQ(supporting_foot(angle), Side::left);
  angle[l_hip_pitch] = -30 * kDegree;
  angle[l_knee] = 60 * kDegree;
  angle[l_ankle_pitch] = -30 * kDegree;
  EXPECT_EQ(supporting_foot(angle), Side::right);
  std::swap(angle[l_hip_pitch], angle[r_hip_pitch]);
  std::swap(angle[l_knee], angle[r_knee]);
  std::swap(angle[l_ankle_pitch], angle[r_ankle_pitch]);
  EXPECT_EQ(supporting_foot(angle), Side::left);
}

TEST(Kinematics, GazePutsThePointOnTheAxis) {
  for (const double x : {0.08, 0.2, 0.5, 2.0}) {
    for (const double y : {-0.6, -0.1, 0.0, 0.15, 0.7}) {
      for (const double z : {-0.16, 0.0, 0.3}) {
        const Eigen::Vector3d point(x, y, z);
        const Gaze gaze = gaze_at(point);
        JointAngles angle{};
        angle[neck_pan] = gaze.pan_rad;
        angle[neck_tilt] = gaze.tilt_rad;
        const Eigen::Vector3d seen = trunk_from_eye(angle).inverse() * point;
        EXPECT_GT(seen.z(), 0);
        EXPECT_LT(std::hypot(seen.x(), seen.y()), 1e-9) << point.transpose();
      }
    }
  }
}

TEST(Kinematics, GazeStaysFiniteAtTheNeck) {
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, 0.118), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0.01, 0.136)}) {
    const Gaze gaze = within_limits(gaze_at(point), 0.01);
    EXPECT_TRUE(std::isfinite(gaze.pan_rad) && std::isfinite(gaze.tilt_rad));
    EXPECT_LE(std::abs(gaze.pan_rad), joint_table()[neck_pan].upper_rad - 0.01);
    EXPECT_LE(gaze.tilt_rad, joint_table()[neck_tilt].upper_rad - 0.01);
  }
}

}  // namespace
}  // namespace kaz::host
