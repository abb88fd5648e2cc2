// A cube as a hull stands, slides and tips on a box and on a hull like a cube as a box.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "sim/body/contact/hull_contact.h"
#include "sim/body/description/convex_hull.h"
#include "sim/body/world/plain_models_testing.h"
#include "sim/body/world/staged_world.h"

namespace kaz::sim {
namespace {

using Eigen::Vector3d;

constexpr double kEdge = 0.06;  // m
const Vector3d kTable(0.3, 0.2, 0.1);

// The same solid as a box, or as a hull of its corners.
RigidLink block(const std::string& name, double mass, const Vector3d& size, double mu, bool hull) {
  RigidLink link = test::box(name, mass, size, {.mu = mu});
  if (!hull) return link;
  std::vector<Vector3d> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(
        Vector3d(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5).cwiseProduct(size));
  link.collisions[0].shape.kind = Shape::Kind::hull;
  link.collisions[0].shape.hull = convex_hull(corners);
  return link;
}

struct Kinds {
  bool cube_is_hull, table_is_hull;
};

// Pose of a cube after `seconds` on a fixed table, whose top is at z = 0, on a slope of `degrees` about y.
// The cube starts `turn_rad` about z and moves with `velocity`.
Eigen::Isometry3d cube_after(double seconds, Kinds kinds, double degrees, double mu,
                             double turn_rad = 0, const Vector3d& velocity = Vector3d::Zero()) {
  const double a = degrees * 3.14159265358979323846 / 180;
  WorldModel world;
  world.gravity = 9.81 * Vector3d(std::sin(a), 0, -std::cos(a));
  WorldBody table =
      test::thing(block("table", 1, kTable, mu, kinds.table_is_hull), {0, 0, -kTable.z() / 2});
  table.fixed = true;
  world.bodies.push_back(table);
  world.bodies.push_back(test::thing(
      block("cube", 0.2, Vector3d::Constant(kEdge), mu, kinds.cube_is_hull), {0, 0, kEdge / 2}));
  world.bodies.back().pose.linear() =
      Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()).toRotationMatrix();
  auto made = make_world(world, test::fixed_place(), test::free_motor(), {});
  EXPECT_TRUE(made) << made.error().message;
  if (!velocity.isZero()) {
    EXPECT_TRUE((*made)->accelerate("cube", velocity));
  }
  while ((*made)->time_s() < seconds) (*made)->step({}, 10);
  EXPECT_EQ((*made)->diagnostics().summary(), "");
  return (*made)->pose().frames.back();
}

// Largest difference of a corner of the cube, m.
double corner_difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  double most = 0;
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner = kEdge / 2 * Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    most = std::max(most, (a * corner - b * corner).norm());
  }
  return most;
}

class HullContact : public testing::TestWithParam<Kinds> {
 protected:
  static void expect_as_box(double seconds, double degrees, double mu, double turn_rad,
                            const Vector3d& velocity, double bound_m) {
    const auto box = cube_after(seconds, {false, false}, degrees, mu, turn_rad, velocity);
    const auto hull = cube_after(seconds, GetParam(), degrees, mu, turn_rad, velocity);
    const double off = corner_difference(box, hull);
    std::printf("moves %.1f mm, off by %.3f mm\n", 1e3 * box.translation().head<2>().norm(),
                1e3 * off);
    EXPECT_LT(off, bound_m);
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, HullContact,
                         testing::Values(Kinds{true, false}, Kinds{false, true},
                                         Kinds{true, true}));

TEST_P(HullContact, StandsStill) {
  expect_as_box(2, 0, 0.5, 0, Vector3d::Zero(), 1e-4);
  expect_as_box(2, 0, 0.5, 0.4, Vector3d::Zero(), 1e-4);
}

TEST_P(HullContact, StandsOnASlope) {
  expect_as_box(2, 15, 0.5, 0, Vector3d::Zero(), 2e-4);
}

TEST_P(HullContact, Slides) {
  expect_as_box(1, 0, 0.2, 0, {0.5, 0, 0}, 1e-3);
  expect_as_box(1, 0, 0.2, 0.4, {0.4, 0.2, 0}, 1e-3);
}

// The cube slides 14 cm, and stops with its center 1 cm inside the edge of the table.
TEST_P(HullContact, StandsBesideAnEdge) {
  const auto stands = cube_after(1, GetParam(), 0, 0.05, 0, {0.37, 0, 0});
  const Vector3d up = stands.linear().col(2);
  EXPECT_GT(up.z(), 0.999) << stands.translation().transpose();
}

// ODE's normal points to the side of the table where the solids only just touch.
TEST(FaceContact, CorrectsAWrongNormal) {
  const RigidLink hull = block("cube", 1, Vector3d::Constant(kEdge), 1, true);
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  const Vector3d half = kTable / 2, cube_at(0, 0, kEdge / 2 - 1e-6), table_at(0, 0, -half.z());
  const Polyhedron cube{hull.collisions[0].shape.hull.get(), half, axes, cube_at};
  const Polyhedron table{nullptr, half, axes, table_at};
  Vector3d normal = Vector3d::UnitY();
  std::vector<DeepPoint> points;
  ASSERT_TRUE(face_contact(cube, table, 1e-6, normal, points));
  EXPECT_LT((normal - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_EQ(points.size(), 4u);
  for (const DeepPoint& point : points) EXPECT_NEAR(point.second, 1e-6, 1e-9);
}

TEST(FaceContact, LeavesEdgesToOde) {
  const RigidLink hull = block("cube", 1, Vector3d::Constant(kEdge), 1, true);
  const double up = kEdge * std::sqrt(0.5);
  const Eigen::Matrix3d a = Eigen::AngleAxisd(std::atan(1.0), Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d b = Eigen::AngleAxisd(std::atan(1.0), Vector3d::UnitY()).toRotationMatrix();
  const Vector3d half = Vector3d::Constant(kEdge / 2), a_at(0, 0, 2 * up - 5e-4),
                 b_at = Vector3d::Zero();
  const Polyhedron upper{hull.collisions[0].shape.hull.get(), half, a, a_at};
  const Polyhedron lower{nullptr, half, b, b_at};
  Vector3d normal = Vector3d::UnitZ();
  std::vector<DeepPoint> points;
  EXPECT_FALSE(face_contact(upper, lower, 5e-4, normal, points));
  EXPECT_EQ(normal, Vector3d::UnitZ());
}

}  // namespace
}  // namespace kaz::sim
