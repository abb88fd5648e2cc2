// The whole robot: it stands, moves by its motors alone, and two runs are equal.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "shared/base/angle.hpp"
#include "sim/body/description/files_testing.h"
#include "sim/body/description/motor_file.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/world/staged_world.h"

namespace kaz::sim {
namespace {

using test::Drives;
using test::run;

// The walking crouch: hip axes at 0.145, which its leg angles give.
std::array<double, KZ_JOINTS> crouch() {
  std::array<double, KZ_JOINTS> target{};
  const auto set = [&](const std::string& name, double degrees) {
    for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
      if (joint_names()[i] == name) target[i] = degrees * kDegree;
    }
  };
  for (const std::string side : {"l_", "r_"}) {
    set(side + "hip_pitch", -30.8);
    set(side + "knee", 55.6);
    set(side + "ankle_pitch", -27.8);
    set(side + "sh_pitch", 10);
    set(side + "elbow", -40);
    set(side + "sh_roll", side == "l_" ? 12 : -12);
  }
  return target;
}

// An ideal servo loop: straight to the duty, no wire and no potentiometer between.
Drives servo(const World& world, const std::array<double, KZ_JOINTS>& target) {
  Drives drives;
  for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
    const JointState& joint = world.joints()[i];
    drives[i] = {20 * (target[i] - joint.angle) - 0.15 * joint.velocity, true};
  }
  return drives;
}

// Into the crouch within 1 s, then held.
void step_towards_crouch(World& world) {
  auto target = crouch();
  const double share = std::min(1.0, world.time_s());
  for (double& angle : target) angle *= share;
  world.step(servo(world, target), 10);
}

std::vector<unsigned char> bytes_of(const World& world) {
  std::vector<unsigned char> bytes;
  const auto add = [&](const void* data, std::size_t size) {
    const auto* p = static_cast<const unsigned char*>(data);
    bytes.insert(bytes.end(), p, p + size);
  };
  for (const JointState& joint : world.joints()) {
    for (const double x : {joint.angle, joint.velocity, joint.torque}) add(&x, sizeof x);
  }
  for (const Eigen::Isometry3d& frame : world.pose().frames) {
    add(frame.matrix().data(), sizeof(double) * 16);
  }
  return bytes;
}

double tilt(const World& world) {
  return std::acos(std::min(1.0, world.link_pose("trunk").linear()(2, 2)));
}

class Standing : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<World> load(const std::string& path = test::kEmpty, std::uint64_t seed = 1) {
    WorldOptions options;
    options.dynamics = GetParam();
    options.seed = seed;
    return test::load_or_fail(path, options);
  }
};

INSTANTIATE_TEST_SUITE_P(Dynamics, Standing, testing::Values("quick50", "exact", "reduced"));

TEST_P(Standing, StartsStraightOnTheFloor) {
  const auto world = load();
  ASSERT_TRUE(world);
  EXPECT_NEAR(world->link_pose("trunk").translation().z(), 0.160, 1e-9);
  for (const JointState& joint : world->joints()) EXPECT_EQ(joint.angle, 0);
  EXPECT_EQ(world->time_s(), 0);
  // Head, and eyes in it, where the URDF puts them.
  const Eigen::Vector3d eye = world->link_pose("left_eye").translation();
  EXPECT_TRUE(eye.isApprox(Eigen::Vector3d(0.030, 0.020, 0.318), 1e-9)) << eye.transpose();
  EXPECT_EQ(world->scene().frames[static_cast<std::size_t>(world->head_frame())], "neck_tilt");
}

TEST_P(Standing, StaysUpWithItsMotorsOff) {
  const auto world = load();
  ASSERT_TRUE(world);
  run(*world, 3.0);
  // Hip, knee and ankle each give by half of their gap, 0.2 degrees, and the soft sole by 0.1.
  EXPECT_LT(tilt(*world), 0.7 * kDegree);
  EXPECT_NEAR(world->link_pose("trunk").translation().z(), 0.160, 0.001);
  EXPECT_EQ(world->supply_current_a(), 0);
  EXPECT_LT(world->largest_joint_gap_m(), 2e-5);
}

TEST_P(Standing, CrouchesAndStaysUpUnderPower) {
  const auto world = load();
  ASSERT_TRUE(world);
  while (world->time_s() < 3.0) step_towards_crouch(*world);
  EXPECT_LT(tilt(*world), 5 * kDegree);  // the crouch leans 3 degrees forward
  EXPECT_NEAR(world->link_pose("trunk").translation().z(), 0.145, 0.003);
  const auto target = crouch();
  for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
    // Stiction (0.166 Nm) and the weight leave an error: at 45.8 Nm/rad less than a degree.
    EXPECT_NEAR(world->joints()[i].angle, target[i], kDegree) << joint_names()[i];
  }
  EXPECT_LT(world->largest_joint_gap_m(), 2e-4);
}

TEST_P(Standing, SameSeedSameBytesEvenBesideAnotherWorld) {
  const auto alone = load();
  ASSERT_TRUE(alone);
  for (int i = 0; i < 600; ++i) step_towards_crouch(*alone);
  const auto first = load(), second = load(test::kBall, 7);
  ASSERT_TRUE(first && second);
  for (int i = 0; i < 600; ++i) {
    step_towards_crouch(*first);
    step_towards_crouch(*second);
  }
  EXPECT_EQ(bytes_of(*first), bytes_of(*alone));
}

TEST(Seed, ShufflesTheRowsOfQuickStep) {
  const auto a = test::load_or_fail(test::kEmpty, {.seed = 1, .dynamics = "quick50"});
  const auto b = test::load_or_fail(test::kEmpty, {.seed = 2, .dynamics = "quick50"});
  ASSERT_TRUE(a && b);
  for (int i = 0; i < 200; ++i) {
    step_towards_crouch(*a);
    step_towards_crouch(*b);
  }
  EXPECT_NE(bytes_of(*a), bytes_of(*b));
}

TEST(Motors, EachTurnsItsOwnJointPositively) {
  const auto robot = load_robot(test::kRobot);
  const auto motor = load_motor_file("shared/robot/kaz/motor.xml", "");
  ASSERT_TRUE(robot && motor);
  WorldModel space;
  space.gravity.setZero();
  for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
    const auto loaded = make_world(space, *robot, *motor, {});
    ASSERT_TRUE(loaded);
    World& world = **loaded;
    Drives drives{};
    drives[i] = {0.5, true};
    run(world, 0.008, drives);  // before an arm turned inwards meets the leg
    EXPECT_GT(world.joints()[i].angle, 0.004) << joint_names()[i];
    EXPECT_GT(world.joints()[i].velocity, 1.0) << joint_names()[i];
    EXPECT_GT(world.supply_current_a(), 0);
    for (std::size_t other = 0; other < KZ_JOINTS; ++other) {
      if (other == i) continue;
      // Reaction may break a neighbour loose, but moves it less.
      EXPECT_LT(std::abs(world.joints()[other].angle), world.joints()[i].angle)
          << joint_names()[other] << " beside " << joint_names()[i];
    }
  }
}

TEST_P(Standing, PanReachesTheNoLoadSpeedOfTheMotor) {
  const auto world = load();
  ASSERT_TRUE(world);
  Drives drives{};
  drives[0] = {-1.0, true};
  run(*world, 0.3, drives);  // to the right stop
  // Mechanical stop 1 degree beyond the limit of 90.
  EXPECT_NEAR(world->joints()[0].angle, -91 * kDegree, 1.0 * kDegree);
  drives[0] = {1.0, true};
  run(*world, 0.1, drives);
  // (0.2288 * 10 - 0.128) / 0.1764 rad/s; the neck's own inertia delays it by some 3 ms.
  EXPECT_NEAR(world->joints()[0].velocity, 12.245, 0.1);
}

TEST_P(Standing, LimpArmFallsAndRestsAtItsFriction) {
  // Raised forward by 60 degrees and released: gravity on the arm (at most 0.11 Nm) is less than the
  // breakaway torque of 0.166 Nm, so the geared joint stays where it is.
  const auto world = load();
  ASSERT_TRUE(world);
  std::array<double, KZ_JOINTS> target{};
  target[2] = -60 * kDegree;
  while (world->time_s() < 0.6) world->step(servo(*world, target), 10);
  const double raised = world->joints()[2].angle;
  run(*world, 0.5);
  EXPECT_NEAR(world->joints()[2].angle, raised, 0.3 * kDegree);
}

TEST(Motors, ReportTemperatureAndCurrent) {
  for (const bool ideal : {false, true}) {
    WorldOptions options;
    options.hung = true;
    options.ideal_motors = ideal;
    const auto world = test::load_or_fail(test::kEmpty, options);
    ASSERT_TRUE(world);
    EXPECT_EQ(world->joints()[0].winding_celsius, 25);
    Drives drives{};
    drives[0] = {-1.0, true};
    run(*world, 1.0, drives);  // against its stop, 30 W at 5 J/K
    EXPECT_NEAR(world->joints()[0].winding_celsius, ideal ? 25 : 30, 1.0);
    EXPECT_NEAR(world->joints()[0].current, -2.95, 0.05);
    EXPECT_NEAR(world->joints()[1].winding_celsius, 25, 0.01);  // what it is shaken
    EXPECT_NEAR(world->supply_current_a(), 2.95, 0.05);
  }
}

// Full drive against a stop, and off it again. 2.4 Nm would give the neck (3e-5 kg m2) 80 rad/s in a step:
// fifty iterations leave less than a hundredth of them.
TEST_P(Standing, LiesStillAgainstAStop) {
  for (const double sign : {-1.0, 1.0}) {
    const auto world = load();
    ASSERT_TRUE(world);
    Drives drives{};
    drives[0] = {sign, true};
    run(*world, 0.4, drives);
    double fastest = 0, furthest = 0, min = 9;
    for (int i = 0; i < 400; ++i) {
      world->step(drives, 10);
      const JointState& neck = world->joints()[0];
      fastest = std::max(fastest, std::abs(neck.velocity));
      furthest = std::max(furthest, sign * neck.angle);
      min = std::min(min, sign * neck.torque);
    }
    EXPECT_LT(fastest, 0.8);
    EXPECT_NEAR(furthest, 91 * kDegree, 0.002) << "the stop gives by 1 mrad";
    EXPECT_GT(min, 1.9) << "2.29 Nm less friction and what 5 K of heat take";
    drives[0] = {-sign, true};
    run(*world, 0.1, drives);
    EXPECT_LT(sign * world->joints()[0].velocity, -11) << "nothing holds it there";
  }
}

TEST(Scene, NamesAreUniqueAndFramesInRange) {
  const auto world = test::load_or_fail(test::kBall, {});
  ASSERT_TRUE(world);
  const Scene& scene = world->scene();
  const ScenePose pose = world->pose();
  ASSERT_EQ(pose.frames.size(), scene.frames.size());
  EXPECT_EQ(scene.frames[0], "world");
  std::vector<std::string> names;
  for (const Visual& visual : scene.visuals) {
    ASSERT_LT(static_cast<std::size_t>(visual.frame), scene.frames.size());
    names.push_back(visual.name);
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST(BallWorld, HidesTheBallFromTheFirstViewAndKeepsItInReach) {
  WorldOptions options;
  options.dynamics = "quick20";
  const auto world = test::load_or_fail(test::kBall, options);
  ASSERT_TRUE(world);
  const auto bearing = [&] {
    const Eigen::Vector3d ball = world->object_position("ball").value();
    return std::atan2(ball.y(), ball.x());
  };
  EXPECT_GT(bearing(), 45 * kDegree) << "half of the view is 40 degrees";
  const Drives drives{};
  double travelled = 0;
  Eigen::Vector3d last = world->object_position("ball").value();
  for (int i = 0; i < 20000; ++i) {
    world->step(drives, 10);
    if (i % 10 != 0) continue;
    const Eigen::Vector3d ball = world->object_position("ball").value();
    ASSERT_LT(std::abs(bearing()), 90 * kDegree);
    ASSERT_GT(ball.head<2>().norm(), 0.35);
    ASSERT_LT(ball.head<2>().norm(), 0.90);
    travelled += (ball - last).norm();
    last = ball;
  }
  EXPECT_GT(travelled, 1.0);
}

}  // namespace
}  // namespace kaz::sim
