// The table of links against the robot's description.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/body_model.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

namespace kaz::motion {
namespace {

using Eigen::Vector3d;

Vector3d vector(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

TEST(BodyModel, LinksAreTheUrdfs) {
  const auto model = urdf::parseURDFFile("shared/robot/kaz/kaz.urdf");
  ASSERT_TRUE(model);
  double total = 0;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const std::string name = host::joint_table()[j].name;
    const auto joint = model->getJoint(name);
    const auto link = model->getLink(name);
    ASSERT_TRUE(joint && link) << name;
    const Link& ours = links()[j];
    const std::string parent =
        ours.parent < 0 ? "trunk" : host::joint_table()[static_cast<std::size_t>(ours.parent)].name;
    EXPECT_EQ(parent, joint->parent_link_name) << name;
    const auto& origin = joint->parent_to_joint_origin_transform;
    EXPECT_TRUE(ours.origin.isApprox(vector(origin.position), 1e-9) ||
                (ours.origin - vector(origin.position)).norm() < 1e-9)
        << name;
    EXPECT_NEAR((ours.axis - vector(joint->axis)).norm(), 0, 1e-9) << name;
    EXPECT_NEAR(ours.mass, link->inertial->mass, 1e-9) << name;
    EXPECT_NEAR((ours.centre - vector(link->inertial->origin.position)).norm(), 0, 1e-9) << name;
    total += link->inertial->mass;
  }
  const auto trunk = model->getLink("trunk");
  EXPECT_NEAR(kTrunkMass, trunk->inertial->mass, 1e-9);
  EXPECT_NEAR(kTotalMass, total + kTrunkMass, 1e-9);
}

// kaz-model: straight, the centre of mass is 0.1705 above the soles; in the crouch 0.159, 4.5 mm ahead
// of the ankles (its shoulders are 10 mm closer together, which changes neither).
TEST(BodyModel, CentreOfMassIsWhereItWasFound) {
  const Vector3d straight = centre_of_mass(JointAngles{});
  EXPECT_NEAR(straight.z() + 0.160, 0.1705, 0.0005);
  EXPECT_NEAR(straight.y(), 0, 1e-12);
}

TEST(BodyModel, ForwardAgreesWithTheOtherKinematics) {
  JointAngles angles{};
  for (std::size_t j = 0; j < angles.size(); ++j)
    angles[j] = 0.3 * std::sin(1.7 * static_cast<double>(j));
  const Poses poses = forward(angles);
  const Eigen::Translation3d sole(0, 0, -host::kLeg.ankle_height);
  EXPECT_TRUE((poses[host::l_ankle_pitch] * sole)
                  .isApprox(host::trunk_from_sole(angles, Side::left), 1e-12));
  EXPECT_TRUE((poses[host::r_ankle_pitch] * sole)
                  .isApprox(host::trunk_from_sole(angles, Side::right), 1e-12));
  // Straight arms hang: the grasp is 70 + 93 mm below the shoulder.
  const Eigen::Isometry3d hand = trunk_from_grasp(JointAngles{}, Side::right);
  EXPECT_NEAR((hand.translation() - Vector3d(0, -0.080, 0.100 - 0.163)).norm(), 0, 1e-12);
}

double distance_m(const Vector3d& p, const Limb& limb) {
  const Vector3d along = limb.to - limb.from;
  const double t = std::clamp((p - limb.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - limb.from - t * along).norm();
}

TEST(BodyModel, LimbsHoldTheUrdfsShapes) {
  const auto model = urdf::parseURDFFile("shared/robot/kaz/kaz.urdf");
  ASSERT_TRUE(model);
  JointAngles angles{};
  for (std::size_t j = 0; j < angles.size(); ++j)
    angles[j] = 0.4 * std::sin(2.3 * static_cast<double>(j) + 1);
  const Poses poses = forward(angles);
  const auto all = limbs(angles);
  int corners = 0;
  for (const char* name : {"sh_roll", "elbow", "hand", "hip_pitch", "knee", "ankle_pitch"}) {
    for (const std::string side : {"l_", "r_"}) {
      const auto link = model->getLink(side + name);
      ASSERT_TRUE(link);
      for (const auto& shape : link->collision_array) {
        const auto box = std::dynamic_pointer_cast<urdf::Box>(shape->geometry);
        ASSERT_TRUE(box) << link->name;
        const auto& q = shape->origin.rotation;
        const Eigen::Isometry3d own =
            poses[static_cast<std::size_t>(*host::joint_index(side + name))] *
            Eigen::Translation3d(vector(shape->origin.position)) *
            Eigen::Quaterniond(q.w, q.x, q.y, q.z);
        for (int corner = 0; corner < 8; ++corner) {
          const Vector3d signs(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5,
                               corner & 4 ? 0.5 : -0.5);
          const Vector3d p = own * signs.cwiseProduct(vector(box->dim));
          EXPECT_TRUE(std::ranges::any_of(
              all, [&](const Limb& limb) { return distance_m(p, limb) <= limb.radius_m; }))
              << link->name << " " << shape->name;
          ++corners;
        }
      }
    }
  }
  EXPECT_GT(corners, 100);
}

}  // namespace
}  // namespace kaz::motion
