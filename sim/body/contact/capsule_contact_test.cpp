// Contact points of a capsule on a face of a box.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/capsule_contact.h"

#include <gtest/gtest.h>

namespace kaz::sim {
namespace {

using Eigen::Vector3d;

constexpr double kCapsuleRadius = 0.01;  // m
const Vector3d kBoxHalf(0.1, 0.05, 0.02);

// A box at `at`, turned by 0.3 rad, and a capsule in the box's axes.
struct Lying {
  Eigen::Matrix3d axes = Eigen::AngleAxisd(0.3, Vector3d(0, 0.6, 0.8)).toRotationMatrix();
  Vector3d at{1, 2, 3};
  std::array<DeepPoint, 2> points;

  bool meet(const Vector3d& middle, const Vector3d& half_axis, const Vector3d& normal) {
    return capsule_on_face({at + axes * middle, axes * half_axis, kCapsuleRadius},
                           {nullptr, kBoxHalf, axes, at}, axes * normal, points);
  }
  Vector3d in_box(std::size_t i) const { return axes.transpose() * (points[i].first - at); }
};

TEST(CapsuleContact, HasBothEndsOfTheLine) {
  Lying lying;
  ASSERT_TRUE(lying.meet({0, 0, 0.029}, {0.03, 0, 0}, Vector3d::UnitZ()));
  EXPECT_LT((lying.in_box(0) - Vector3d(-0.03, 0, 0.0195)).norm(), 1e-12);
  EXPECT_LT((lying.in_box(1) - Vector3d(0.03, 0, 0.0195)).norm(), 1e-12);
  for (const DeepPoint& point : lying.points) EXPECT_NEAR(point.second, 0.001, 1e-12);
}

TEST(CapsuleContact, EndsAtTheEdgesOfTheFace) {
  Lying lying;
  ASSERT_TRUE(lying.meet({0.01, -0.055, 0.01}, {0.5, 0, 0}, -Vector3d::UnitY()));
  EXPECT_NEAR(lying.in_box(0).x(), -0.1, 1e-12);
  EXPECT_NEAR(lying.in_box(1).x(), 0.1, 1e-12);
}

TEST(CapsuleContact, HasTheDepthOfEachEnd) {
  Lying lying;
  ASSERT_TRUE(lying.meet({0, 0, 0.028}, {0.03, 0, 0.001}, Vector3d::UnitZ()));
  EXPECT_NEAR(lying.points[0].second, 0.003, 1e-12);
  EXPECT_NEAR(lying.points[1].second, 0.001, 1e-12);
}

TEST(CapsuleContact, IsNoneOnEdgesAndWithOneEnd) {
  Lying lying;
  EXPECT_FALSE(lying.meet({0, 0, 0.028}, {0.03, 0, 0}, Vector3d(0, 0.6, 0.8)));
  EXPECT_FALSE(lying.meet({0, 0, 0.03}, {0.03, 0, 0.005}, Vector3d::UnitZ()));
  EXPECT_FALSE(lying.meet({0, 0.06, 0.028}, {0.03, 0, 0}, Vector3d::UnitZ())) << "beside the face";
  EXPECT_FALSE(lying.meet({0, 0, 0.05}, {0, 0, 0.03}, Vector3d::UnitZ())) << "it stands";
}

}  // namespace
}  // namespace kaz::sim
