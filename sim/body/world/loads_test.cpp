// Sensors of force against weights, closed forms, and each other.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/world/loads.h"

#include <algorithm>
#include <cmath>

#include "shared/base/angle.hpp"
#include "sim/body/description/files_testing.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {
namespace {

using Eigen::Vector3d;
using test::Drives;
using Targets = std::array<double, KZ_JOINTS>;

constexpr double kGravity = 9.81;

std::size_t joint_number(const std::string& name) {
  const auto& names = joint_names();
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

Drives servo(const World& world, const Targets& targets) {
  Drives drives;
  for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
    const JointState& joint = world.joints()[i];
    drives[i] = {20 * (targets[i] - joint.angle) - 0.15 * joint.velocity, true};
  }
  return drives;
}

const RobotModel& kaz() {
  static const RobotModel model = load_robot(test::kRobot).value();
  return model;
}

// A link and all that it carries.
struct Weight {
  double mass = 0;
  Vector3d first = Vector3d::Zero();  // mass * place
};
Weight carried_by(const World& world, int link) {
  Weight weight;
  std::vector<bool> carried(kaz().links.size(), false);
  for (std::size_t i = 0; i < kaz().links.size(); ++i) {
    const RobotLink& at = kaz().links[i];
    carried[i] = static_cast<int>(i) == link ||
                 (at.parent >= 0 && carried[static_cast<std::size_t>(at.parent)]);
    if (!carried[i]) continue;
    weight.mass += at.rigid.mass;
    weight.first += at.rigid.mass * (world.link_pose(at.rigid.name) * at.rigid.com);
  }
  return weight;
}

class Loads : public testing::TestWithParam<const char*> {
 protected:
  static std::unique_ptr<World> load(bool hung, const std::string& path = test::kEmpty) {
    WorldOptions options;
    options.dynamics = GetParam();
    options.hung = hung;
    options.ideal_motors = true;
    return test::load_or_fail(path, options);
  }
};
INSTANTIATE_TEST_SUITE_P(Dynamics, Loads, testing::Values("reduced", "exact", "quick50"),
                         [](const auto& name) { return std::string(name.param); });

TEST_P(Loads, SolesBearTheWeightUnderTheCentreOfMass) {
  const auto world = load(false);
  ASSERT_TRUE(world);
  const Targets straight{};
  for (int i = 0; i < 1000; ++i) world->step(servo(*world, straight), 10);
  const Weight robot = carried_by(*world, 0);
  constexpr int kMean = 100;
  Vector3d force = Vector3d::Zero(), pressure_at = Vector3d::Zero(), mass_at = Vector3d::Zero();
  double pressure = 0;
  for (int i = 0; i < kMean; ++i) {
    world->step(servo(*world, straight), 10);
    ASSERT_EQ(world->link_forces().size(), kaz().links.size());
    for (std::size_t k = 0; k < kaz().links.size(); ++k) {
      const LinkForce& link = world->link_forces()[k];
      const std::string& name = world->link_order()[k];
      const bool sole = name.ends_with("ankle_pitch");
      ASSERT_EQ(link.pressure > 0, sole) << name;
      ASSERT_TRUE(sole || link.force.isZero()) << name;
      const Eigen::Isometry3d frame = world->link_pose(name);
      force += frame.linear() * link.force / kMean;
      pressure += link.pressure / kMean;
      pressure_at += link.pressure * (frame * link.centre) / kMean;
      if (!sole) continue;
      EXPECT_NEAR((frame * link.centre).z(), 0, 0.5e-3);  // softness gives 0.25 mm
      EXPECT_GT(link.pressure, 0.3 * robot.mass * kGravity);
      // Across the floor no moment is left at the centre of pressure but what friction has on the arm
      // of its height: nothing.
      const Vector3d left = frame.linear() * (link.moment - link.centre.cross(link.force));
      EXPECT_LT(left.head<2>().norm(), 2e-3) << name;
    }
    mass_at += carried_by(*world, 0).first / robot.mass / kMean;
  }
  // It still sways by some 1e-2 m/s^2 on its soft soles.
  EXPECT_NEAR(force.z(), robot.mass * kGravity, 0.01 * robot.mass * kGravity);
  EXPECT_NEAR(pressure, force.z(), 0.01 * force.z());
  // 1e-2 m/s^2 across at 0.2 m of height move the centre of pressure by 0.2 mm.
  EXPECT_LT((pressure_at / pressure - mass_at).head<2>().norm(), 0.5e-3);
}

// Arms out, forearms bent: every joint bears what hangs on it. What is left of the motion is below
// 1e-3 of gravity.
TEST_P(Loads, JointsOfTheHungRobotBearWhatHangsOnThem) {
  const auto world = load(true);
  ASSERT_TRUE(world);
  Targets targets{};
  targets[joint_number("l_sh_roll")] = 90 * kDegree;
  targets[joint_number("r_sh_pitch")] = -60 * kDegree;
  targets[joint_number("r_elbow")] = -50 * kDegree;
  targets[joint_number("neck_tilt")] = 30 * kDegree;
  targets[joint_number("l_hip_pitch")] = -40 * kDegree;
  for (int i = 0; i < 1500; ++i) world->step(servo(*world, targets), 10);
  EXPECT_TRUE(world->joint_loads().empty());
  world->watch_loads(true);
  // Iterations leave a rest, another one in each step; their mean is as good as the others' single step.
  const int steps = std::string(GetParam()) == "quick50" ? 200 : 1;
  std::array<JointLoad, KZ_JOINTS> mean;
  for (int i = 0; i < steps; ++i) {
    world->step(servo(*world, targets), 10);
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      mean[j].force += world->joint_loads()[j].force / steps;
      mean[j].moment += world->joint_loads()[j].moment / steps;
    }
  }
  ASSERT_EQ(world->joint_loads().size(), KZ_JOINTS);
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const RobotLink& child = kaz().links[static_cast<std::size_t>(kaz().joints[j].child)];
    const Weight weight = carried_by(*world, kaz().joints[j].child);
    const Eigen::Isometry3d frame = world->link_pose(child.rigid.name);
    const Vector3d up = kGravity * Vector3d::UnitZ();
    const Vector3d arm = weight.first - weight.mass * frame.translation();
    const JointLoad& load = mean[j];
    const double part = steps > 1 ? 2e-2 : 2e-3;
    EXPECT_LT((frame.linear() * load.force - weight.mass * up).norm(),
              part * weight.mass * kGravity)
        << child.rigid.name;
    EXPECT_LT((frame.linear() * load.moment - arm.cross(up)).norm(),
              part * (arm.cross(up).norm() + weight.mass * kGravity * 0.05))
        << child.rigid.name;
  }
  // Numbers: a head of 80 g on the neck; the left shoulder holds 145 g at 68 mm, by hand.
  const auto& neck = mean[joint_number("neck_pan")];
  EXPECT_NEAR(neck.force.z(), 0.080 * kGravity, 0.02);
  const double by_hand =
      kGravity * (0.070 * 0.035 + 0.060 * (0.070 + 0.030) + 0.015 * (0.070 + 0.065 + 0.020));
  EXPECT_NEAR(mean[joint_number("l_sh_roll")].moment.norm(), by_hand, 0.05 * by_hand);
}

// It falls, motors open and at rest against each other: nothing touches, and nothing bears anything.
TEST_P(Loads, InFreeFallThereAreNone) {
  const test::Folder folder;
  std::string text = test::world_text("0 0 -9.81", "");
  const std::string start = "0 -3 0 0 0 0";
  text.replace(text.find(start), start.size(), "0 -3 1 0 0 0");
  const auto world = load(false, folder.write("world.sdf", text));
  ASSERT_TRUE(world);
  world->watch_loads(true);
  test::run(*world, 0.3);
  for (const LinkForce& link : world->link_forces()) EXPECT_EQ(link.pressure, 0);
  for (const JointLoad& load : world->joint_loads()) {
    EXPECT_LT(load.force.norm(), 1e-5);
    EXPECT_LT(load.moment.norm(), 1e-5);
  }
}

// Stepping from foot to foot, and squatting: along its axis a joint's load is what the motor gives.
TEST_P(Loads, AlongItsAxisItIsTheMotor) {
  const auto world = load(false);
  ASSERT_TRUE(world);
  world->watch_loads(true);
  double strongest = 0;
  for (int i = 0; i < 600; ++i) {
    const double bend = 0.5 * std::sin(5 * world->time_s());
    Targets targets{};
    for (const char* side : {"l_", "r_"}) {
      const std::string s = side;
      targets[joint_number(s + "hip_pitch")] = -std::abs(bend);
      targets[joint_number(s + "knee")] = 2 * std::abs(bend);
      targets[joint_number(s + "ankle_pitch")] = -std::abs(bend);
      targets[joint_number(s + "hip_roll")] = 0.1 * std::sin(9 * world->time_s());
    }
    world->step(servo(*world, targets), 10);
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      const RobotLink& child = kaz().links[static_cast<std::size_t>(kaz().joints[j].child)];
      const Vector3d axis = child.at_zero.linear().transpose() * kaz().joints[j].axis;
      const double torque = world->joints()[j].torque;
      // A hinge of ODE has a share of its own along the axis only at its stops. The solver of `reduced`
      // ends at 1e-9 rad/s; times an inertia of 1e-2 kg m^2 by a step that is 1e-8 Nm.
      ASSERT_NEAR(axis.dot(world->joint_loads()[j].moment), torque, 1e-6) << i << child.rigid.name;
      strongest = std::max(strongest, std::abs(torque));
    }
  }
  EXPECT_GT(strongest, 0.2);
}

TEST_P(Loads, WatchingChangesNothingAndStateHoldsTheForces) {
  const auto watched = load(false), plain = load(false), later = load(false);
  ASSERT_TRUE(watched && plain && later);
  watched->watch_loads(true);
  Targets targets{};
  targets[joint_number("l_sh_roll")] = 1;
  targets[joint_number("l_knee")] = 0.3;
  for (int i = 0; i < 300; ++i) {
    watched->step(servo(*watched, targets), 10);
    plain->step(servo(*plain, targets), 10);
  }
  StateWriter a, b;
  watched->save(a);
  plain->save(b);
  EXPECT_EQ(a.bytes(), b.bytes());
  StateReader from(a.bytes());
  later->restore(from);
  ASSERT_TRUE(from.good());
  for (std::size_t i = 0; i < later->link_forces().size(); ++i) {
    EXPECT_EQ(later->link_forces()[i].force, watched->link_forces()[i].force);
    EXPECT_EQ(later->link_forces()[i].centre, watched->link_forces()[i].centre);
  }
  EXPECT_TRUE(later->joint_loads().empty());
}

// Arms and neck of the suspended robot swing, the standing one sways. Compared by root mean square: both
// integrators are of first order, and a joint that breaks away one step earlier in one of them has another
// load in that step.
TEST(LoadsOfBoth, ReducedAndExactAgreeOnARobotThatMoves) {
  for (const bool hung : {true, false}) {
    WorldOptions options;
    options.hung = hung;
    options.ideal_motors = true;
    options.step_s = 2.5e-4;
    const auto reduced = test::load_or_fail(test::kEmpty, options);
    options.dynamics = "exact";
    const auto exact = test::load_or_fail(test::kEmpty, options);
    ASSERT_TRUE(reduced && exact);
    std::array<double, 2> force{}, moment{}, force_apart{}, moment_apart{};  // neck and arms; legs
    double foot = 0, foot_apart = 0;
    constexpr int kSteps = 2400, kFrom = 800;
    for (int i = 0; i < kSteps; ++i) {
      for (const auto& world : {reduced.get(), exact.get()}) {
        const double time = world->time_s();
        Targets targets{};
        for (const char* name : {"neck_pan", "neck_tilt", "l_sh_pitch", "r_sh_pitch", "l_elbow"})
          targets[joint_number(name)] = (hung ? 0.4 : 0.1) * (std::cos(8 * time) - 1);
        if (!hung) {
          for (const char* name : {"l_hip_roll", "r_hip_roll"})
            targets[joint_number(name)] = 0.01 * (std::cos(8 * time) - 1);
        }
        world->watch_loads(i >= kFrom);
        world->step(servo(*world, targets), 10);
      }
      if (i < kFrom) continue;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        const JointLoad &a = reduced->joint_loads()[j], &b = exact->joint_loads()[j];
        const std::size_t leg = j >= joint_number("l_hip_roll") ? 1 : 0;
        force[leg] += b.force.squaredNorm();
        moment[leg] += b.moment.squaredNorm();
        force_apart[leg] += (a.force - b.force).squaredNorm();
        moment_apart[leg] += (a.moment - b.moment).squaredNorm();
      }
      for (std::size_t k = 0; k < kaz().links.size(); ++k) {
        const LinkForce &a = reduced->link_forces()[k], &b = exact->link_forces()[k];
        foot += b.force.squaredNorm();
        foot_apart += (a.force - b.force).squaredNorm();
      }
    }
    for (const std::size_t leg : {0u, 1u}) {
      // Measured: below 5e-5 in the air; on the floor forces 1e-2, moments 3e-2, which are small there.
      // The soles stand in a loop with the floor: how friction shares what they hold against each other
      // is a cone here and a pyramid there, and the trunk sways by that.
      EXPECT_LT(std::sqrt(force_apart[leg] / force[leg]), hung ? 1e-3 : 0.02);
      EXPECT_LT(std::sqrt(moment_apart[leg] / moment[leg]), hung ? 1e-3 : 0.05);
    }
    EXPECT_EQ(foot == 0, hung);
    EXPECT_LE(std::sqrt(foot_apart), 0.02 * std::sqrt(foot));
  }
}

// A push on the head, 0.2 N for a step: the neck bears it with the head's weight, and not as a force of
// contact.
TEST_P(Loads, APushIsBorneByTheJointsBelow) {
  const auto world = load(true);
  ASSERT_TRUE(world);
  const Targets straight{};
  for (int i = 0; i < 500; ++i) world->step(servo(*world, straight), 10);
  world->watch_loads(true);
  world->step(servo(*world, straight), 10);
  const double before = world->joint_loads()[joint_number("neck_pan")].force.z();
  ASSERT_TRUE(world->push("neck_pan", {0, 0, -0.2 * world->step_s()}));
  world->step(servo(*world, straight), 10);
  EXPECT_NEAR(world->joint_loads()[joint_number("neck_pan")].force.z() - before, 0.2,
              std::string(GetParam()) == "quick50" ? 2e-2 : 2e-3);  // what its iterations leave
  for (const LinkForce& link : world->link_forces()) EXPECT_EQ(link.pressure, 0);
}

}  // namespace
}  // namespace kaz::sim
