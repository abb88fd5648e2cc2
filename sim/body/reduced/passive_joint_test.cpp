// Passive joints between free bodies, against closed forms and integrated equations of motion.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numbers>

#include "shared/base/archive.hpp"
#include "sim/body/description/files_testing.h"
#include "sim/body/reduced/reduced_world.h"
#include "sim/body/world/plain_models_testing.h"

namespace kaz::sim {
namespace {

using Eigen::Vector3d;

constexpr double kPivotHeight = 2;                // m
constexpr double kRodArm = test::kRodLength / 2;  // m, from the joint to the center of mass
constexpr double kAboutPivot = test::kRodInertia + test::kRodMass * kRodArm * kRodArm;  // kg m2

// A rod whose upper end is at `at`; it is turned by `angle` about y from its hanging pose.
WorldBody turned_rod(const std::string& name, const Vector3d& at, double angle) {
  WorldBody body = test::thing(test::rod(name), at);
  body.model = "machine";
  body.rigid.name = "machine/" + name;
  body.pose.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix();
  return body;
}

WorldJoint joint_about_y(int parent, int child, const Vector3d& at) {
  WorldJoint joint;
  joint.name = "machine/joint";
  joint.parent = parent;
  joint.child = child;
  joint.anchor = at;
  joint.axis = Vector3d::UnitY();
  return joint;
}

WorldModel pendulum(double angle) {
  const Vector3d pivot(0, 0, kPivotHeight);
  WorldModel world;
  world.bodies.push_back(turned_rod("rod", pivot, angle));
  world.joints.push_back(joint_about_y(-1, 0, pivot));
  return world;
}

ReducedWorld reduced(const WorldModel& world) {
  return ReducedWorld(world, test::fixed_place(), test::free_motor(), {});
}

// Pose of the i-th movable body. Frame 0 is the world, frame 1 the robot's only link.
Eigen::Isometry3d pose_of_body(const ReducedWorld& world, std::size_t i) {
  return world.pose().frames[2 + i];
}

Vector3d lower_end(const Eigen::Isometry3d& rod) {
  return rod * Vector3d(0, 0, -test::kRodLength);
}

// The period of a pendulum is 4 sqrt(I / (m g l)) K(sin(A / 2)) for the amplitude A. Twenty swings later the
// amplitude, and so the energy, is the same.
TEST(PassiveJoint, SwingsWithThePeriodOfALargeAmplitude) {
  constexpr double kAmplitude = 2;
  ReducedWorld world = reduced(pendulum(kAmplitude));
  const double period = 4 * std::sqrt(kAboutPivot / (test::kRodMass * 9.81 * kRodArm)) *
                        std::comp_ellint_1(std::sin(kAmplitude / 2));
  std::vector<double> passes;
  double highest = 0;
  double before = kAmplitude;
  while (passes.size() < 21) {
    world.step({}, 0);
    const double angle = kAmplitude + world.passive_joints()[0];
    if (before < 0 && angle >= 0) {
      passes.push_back(world.time_s() - world.step_s() * angle / (angle - before));
      highest = 0;
    }
    highest = std::max(highest, angle);
    before = angle;
    ASSERT_LT((pose_of_body(world, 0).translation() - Vector3d(0, 0, kPivotHeight)).norm(), 1e-4);
    ASSERT_LT(std::abs(pose_of_body(world, 0).linear().col(0).y()), 1e-4);
    ASSERT_LT(world.time_s(), 60);
  }
  EXPECT_NEAR((passes.back() - passes.front()) / 20 / period, 1, 1e-3);
  for (double at = 0; at >= 0;) {
    world.step({}, 0);
    const double angle = kAmplitude + world.passive_joints()[0];
    if (angle < highest) break;
    highest = at = angle;
  }
  EXPECT_NEAR(highest, kAmplitude, 2e-3);
  EXPECT_EQ(world.diagnostics().unconverged_steps, 0);
}

// Angular accelerations of two rods that hang from one another, with absolute angles and speeds (Lagrange).
std::array<double, 4> double_pendulum(const std::array<double, 4>& s) {
  const double m = test::kRodMass, l = test::kRodLength, g = 9.81;
  const double c = m * l * kRodArm * std::cos(s[0] - s[1]);
  const double d = m * l * kRodArm * std::sin(s[0] - s[1]);
  Eigen::Matrix2d mass;
  mass << kAboutPivot + m * l * l, c, c, kAboutPivot;
  const Eigen::Vector2d force(-d * s[3] * s[3] - g * m * (kRodArm + l) * std::sin(s[0]),
                              d * s[2] * s[2] - g * m * kRodArm * std::sin(s[1]));
  const Eigen::Vector2d a = mass.inverse() * force;
  return {s[2], s[3], a[0], a[1]};
}

// One step of the Runge-Kutta method of fourth order.
std::array<double, 4> integrated(const std::array<double, 4>& s, double h) {
  const auto moved = [&s](const std::array<double, 4>& by, double length) {
    std::array<double, 4> to = s;
    for (std::size_t i = 0; i < 4; ++i) to[i] += length * by[i];
    return to;
  };
  const auto a = double_pendulum(s), b = double_pendulum(moved(a, h / 2)),
             c = double_pendulum(moved(b, h / 2)), d = double_pendulum(moved(c, h));
  std::array<double, 4> to = s;
  for (std::size_t i = 0; i < 4; ++i) to[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  return to;
}

TEST(PassiveJoint, DoublePendulumFollowsItsEquationsOfMotion) {
  const Vector3d pivot(0, 0, kPivotHeight);
  WorldModel around = pendulum(1.5);
  const Vector3d knee = lower_end(around.bodies[0].pose);
  around.bodies.push_back(turned_rod("shank", knee, 0.5));
  around.joints.push_back(joint_about_y(0, 1, knee));
  ReducedWorld world = reduced(around);
  std::array<double, 4> state{1.5, 0.5, 0, 0};
  for (int i = 0; i < 1000; ++i) {
    world.step({}, 0);
    for (int k = 0; k < 10; ++k) state = integrated(state, world.step_s() / 10);
    const Vector3d tip =
        pivot - test::kRodLength * Vector3d(std::sin(state[0]) + std::sin(state[1]), 0,
                                            std::cos(state[0]) + std::cos(state[1]));
    // 1 % of the length of both rods
    ASSERT_LT((lower_end(pose_of_body(world, 1)) - tip).norm(), 0.01 * 2 * test::kRodLength)
        << world.time_s();
    ASSERT_LT((lower_end(pose_of_body(world, 0)) - pose_of_body(world, 1).translation()).norm(),
              1e-4);
  }
}

TEST(PassiveJoint, StopsAtItsLimit) {
  WorldModel around = pendulum(1.2);
  around.joints[0].lower = -1;  // 0.2 rad before the rod hangs
  ReducedWorld world = reduced(around);
  double lowest = 0;
  for (int i = 0; i < 3000; ++i) {
    world.step({}, 0);
    lowest = std::min(lowest, world.passive_joints()[0]);
  }
  EXPECT_LT(lowest, -0.999);
  EXPECT_GT(lowest, -1.001);
  EXPECT_NEAR(world.passive_joints()[0], -1, 1e-4);
}

// Terminal speed of a rod on a slider with damping: m g sin(slope) / d.
TEST(PassiveJoint, SlidesWithDampingAndHoldsItsDirection) {
  WorldModel around = pendulum(0.3);
  around.joints[0].kind = WorldJoint::Kind::prismatic;
  around.joints[0].axis = Vector3d(1, 0, -1).normalized();
  around.joints[0].damping = 2;
  ReducedWorld world = reduced(around);
  const Eigen::Matrix3d turn = pose_of_body(world, 0).linear();
  for (int i = 0; i < 1000; ++i) world.step({}, 0);
  const double before = world.passive_joints()[0];
  world.step({}, 0);
  const double terminal = test::kRodMass * 9.81 * std::sqrt(0.5) / 2;
  EXPECT_NEAR((world.passive_joints()[0] - before) / world.step_s(), terminal, 1e-3 * terminal);
  EXPECT_LT((pose_of_body(world, 0).linear() - turn).norm(), 1e-6);
  const Vector3d moved = pose_of_body(world, 0).translation() - around.bodies[0].pose.translation();
  EXPECT_LT(moved.cross(around.joints[0].axis).norm(), 1e-4);
}

// A rod tilted less than its friction holds stays where it is; with less friction it falls.
TEST(PassiveJoint, FrictionHoldsUpToItsLimit) {
  const double moment = test::kRodMass * 9.81 * kRodArm * std::sin(0.5);
  for (const double share : {0.9, 1.1}) {
    WorldModel around = pendulum(0.5);
    around.joints[0].friction = share * moment;
    ReducedWorld world = reduced(around);
    for (int i = 0; i < 500; ++i) world.step({}, 0);
    if (share > 1) {
      EXPECT_LT(std::abs(world.passive_joints()[0]), 1e-3);
    } else {
      EXPECT_LT(world.passive_joints()[0], -0.02);
    }
  }
}

// A ball joint holds the point and leaves all turns free: the rod swings as a cone.
TEST(PassiveJoint, BallJointHoldsItsPoint) {
  WorldModel around = pendulum(1);
  around.joints[0].kind = WorldJoint::Kind::ball;
  ReducedWorld world = reduced(around);
  ASSERT_TRUE(world.accelerate("machine", {0, 0.5, 0}));
  double across = 0;
  for (int i = 0; i < 1000; ++i) {
    world.step({}, 0);
    ASSERT_LT((pose_of_body(world, 0).translation() - Vector3d(0, 0, kPivotHeight)).norm(), 1e-4);
    across = std::max(across, std::abs(lower_end(pose_of_body(world, 0)).y()));
  }
  EXPECT_GT(across, 0.05);
}

// Two rods and a bar form a parallelogram: one joint more than a tree has, and five redundant rows. The bar
// stays level.
TEST(PassiveJoint, ClosedLoopsAreSolved) {
  const Vector3d left(0, 0, kPivotHeight), right(test::kRodLength, 0, kPivotHeight);
  WorldModel around = pendulum(0.8);
  around.bodies.push_back(turned_rod("other", right, 0.8));
  const Vector3d corner = lower_end(around.bodies[0].pose);
  around.bodies.push_back(turned_rod("bar", corner, -std::numbers::pi / 2));
  around.joints.push_back(joint_about_y(-1, 1, right));
  around.joints.push_back(joint_about_y(0, 2, corner));
  around.joints.push_back(joint_about_y(1, 2, lower_end(around.bodies[1].pose)));
  ReducedWorld world = reduced(around);
  double lowest = 0;
  for (int i = 0; i < 2000; ++i) {
    world.step({}, 0);
    const Eigen::Isometry3d bar = pose_of_body(world, 2);
    ASSERT_LT((lower_end(pose_of_body(world, 0)) - bar.translation()).norm(), 1e-4) << i;
    ASSERT_LT((lower_end(pose_of_body(world, 1)) - lower_end(bar)).norm(), 1e-4) << i;
    ASSERT_LT(std::abs(bar.translation().z() - lower_end(bar).z()), 1e-4) << i;
    lowest = std::min(lowest, world.passive_joints()[0]);
  }
  EXPECT_LT(lowest, -1.5);
  EXPECT_EQ(world.diagnostics().unconverged_steps, 0);
}

// Two blocks with a hinge between them come to rest on the floor, as a heap of blocks without one does.
TEST(PassiveJoint, JointedBodiesRestOnTheFloor) {
  WorldModel around = test::floor_of(Surface{}, {0, 0, -9.81});
  for (const double x : {-0.05, 0.05}) {
    WorldBody block =
        test::thing(test::box(x < 0 ? "machine/a" : "machine/b", 0.2, {0.1, 0.05, 0.03}, Surface{}),
                    {x, 0, 0.1});
    block.model = "machine";
    around.bodies.push_back(block);
  }
  around.joints.push_back(joint_about_y(1, 2, {0, 0, 0.1}));
  ReducedWorld world = reduced(around);
  for (int i = 0; i < 2000; ++i) world.step({}, 0);
  const Vector3d before = pose_of_body(world, 0).translation();
  EXPECT_NEAR(before.z(), 0.015, 1e-3);
  for (int i = 0; i < 100; ++i) world.step({}, 0);
  EXPECT_LT((pose_of_body(world, 0).translation() - before).norm(), 1e-5);
  EXPECT_NEAR(world.passive_joints()[0], 0, 1e-3);
  EXPECT_EQ(world.diagnostics().unconverged_steps, 0);
}

// Bodies of one model that a joint connects do not collide, although they overlap.
TEST(PassiveJoint, JointedBodiesOfAModelDoNotCollide) {
  const auto run = [](bool jointed) {
    WorldModel around = pendulum(0.5);
    around.bodies[0].rigid.collisions.push_back(
        test::touching(Shape::Kind::sphere, {0.05, 0, 0}, Surface{}));
    WorldBody post = turned_rod("post", {0, 0, kPivotHeight}, 0);
    post.fixed = true;
    post.rigid.collisions = around.bodies[0].rigid.collisions;
    around.bodies.push_back(post);
    around.joints[0].parent = jointed ? 1 : -1;
    ReducedWorld world = reduced(around);
    return world.find_contacts();
  };
  EXPECT_EQ(run(true), 0);
  EXPECT_GT(run(false), 0);
}

// The same joints on ODE, which brakes a little: half a swing, the stop, the slider and the ball.
class PassiveJointOn : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<StagedWorld> world(const WorldModel& around) {
    WorldOptions options;
    options.dynamics = GetParam();
    auto made = make_world(around, test::fixed_place(), test::free_motor(), options);
    EXPECT_TRUE(made) << made.error().message;
    return made ? std::move(*made) : nullptr;
  }
};

INSTANTIATE_TEST_SUITE_P(Dynamics, PassiveJointOn, testing::Values("quick50", "exact", "reduced"));

TEST_P(PassiveJointOn, SwingsAndStops) {
  WorldModel around = pendulum(1);
  const auto free = world(around);
  around.joints[0].lower = -0.5;
  const auto stopped = world(around);
  const auto copy = *stopped->clone();
  double farthest = 0;
  for (int i = 0; i < 1000; ++i) {
    free->step({}, 0);
    stopped->step({}, 0);
    copy->step({}, 0);
    farthest = std::max(farthest, lower_end(free->pose().frames[2]).x());
    ASSERT_LT((free->pose().frames[2].translation() - Vector3d(0, 0, kPivotHeight)).norm(), 1e-3);
  }
  EXPECT_NEAR(farthest, test::kRodLength * std::sin(1.0), 0.01);
  const double held = -test::kRodLength * std::sin(0.5);
  EXPECT_NEAR(lower_end(stopped->pose().frames[2]).x(), held, 1e-3);
  EXPECT_EQ(copy->pose().frames[2].matrix(), stopped->pose().frames[2].matrix());
}

TEST_P(PassiveJointOn, SlidesWithDamping) {
  WorldModel around = pendulum(0);
  around.joints[0].kind = WorldJoint::Kind::prismatic;
  around.joints[0].axis = Vector3d::UnitZ();
  around.joints[0].damping = 2;
  const auto sliding = world(around);
  for (int i = 0; i < 1000; ++i) sliding->step({}, 0);
  const double before = sliding->pose().frames[2].translation().z();
  sliding->step({}, 0);
  const double speed = (before - sliding->pose().frames[2].translation().z()) / sliding->step_s();
  EXPECT_NEAR(speed, test::kRodMass * 9.81 / 2, 1e-3);
}

TEST_P(PassiveJointOn, FrictionHolds) {
  WorldModel around = pendulum(0.5);
  around.joints[0].friction = 1;
  const auto held = world(around);
  for (int i = 0; i < 500; ++i) held->step({}, 0);
  EXPECT_LT((held->pose().frames[2].matrix() - around.bodies[0].pose.matrix()).norm(), 1e-3);
}

TEST(PassiveJoint, OdeRefusesWhatItCannotDo) {
  WorldOptions options;
  options.dynamics = "exact";
  WorldModel around = pendulum(0.5);
  around.joints[0].upper = 4;
  const auto far = make_world(around, test::fixed_place(), test::free_motor(), options);
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().message,
            "joint `machine/joint` of the world has a limit beyond 3.1 rad, which only --dynamics "
            "reduced supports; leave out --dynamics");
  around = pendulum(0.5);
  around.joints[0].friction = around.joints[0].damping = 1;
  const auto both = make_world(around, test::fixed_place(), test::free_motor(), options);
  ASSERT_FALSE(both);
  EXPECT_NE(both.error().message.find("damping and friction"), std::string::npos);
}

TEST(PassiveJoint, ContinuesFromCloneAndSavedState) {
  const WorldModel around = pendulum(2);
  ReducedWorld world = reduced(around);
  for (int i = 0; i < 700; ++i) world.step({}, 0);
  const auto clone = *world.clone();
  StateWriter saved;
  world.save(saved);
  ReducedWorld restored = reduced(around);
  StateReader reader(saved.bytes());
  restored.restore(reader);
  ASSERT_TRUE(reader.good());
  for (int i = 0; i < 700; ++i) {
    world.step({}, 0);
    clone->step({}, 0);
    restored.step({}, 0);
  }
  EXPECT_EQ(restored.passive_joints(), world.passive_joints());
  EXPECT_EQ(pose_of_body(restored, 0).matrix(), pose_of_body(world, 0).matrix());
  EXPECT_EQ(clone->pose().frames[2].matrix(), pose_of_body(world, 0).matrix());
}

}  // namespace
}  // namespace kaz::sim
