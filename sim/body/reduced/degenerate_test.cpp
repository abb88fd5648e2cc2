// Degenerate input: the solver stays finite, and steps without a solution are reported.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <optional>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/motor_file.h"
#include "sim/body/reduced/reduced_world.h"

namespace kaz::sim {
namespace {

using test::Drives;

class Degenerate : public testing::Test {
 protected:
  std::unique_ptr<ReducedWorld> load(const WorldModel& around, const RobotModel& robot,
                                     const MotorParams& motor) {
    return std::make_unique<ReducedWorld>(around, robot, motor, WorldOptions{});
  }
  std::unique_ptr<ReducedWorld> kaz_in(const WorldModel& around) {
    const auto robot = load_robot(test::kRobot);
    const auto motor = load_motor_file("shared/robot/kaz/motor.xml", "");
    EXPECT_TRUE(robot && motor);
    return robot && motor ? load(around, *robot, *motor) : nullptr;
  }
  std::unique_ptr<ReducedWorld> kaz_among(const std::string& models) {
    auto around = load_world(folder_.write("w.sdf", test::world_text("0 0 -9.81", models)));
    EXPECT_TRUE(around) << (around ? "" : around.error().message);
    return around ? kaz_in(*around) : nullptr;
  }
  static std::string number_of(int i) {
    std::string name = "b";
    return name += std::to_string(i);
  }
  static std::string box(const std::string& name, const std::string& at, const std::string& mu) {
    return "<model name=\"" + name + "\"><pose>" + at +
           " 0 0 0</pose><link name=\"l\"><inertial><mass>0.05</mass><inertia><ixx>1.4e-5</ixx>"
           "<iyy>1.4e-5</iyy><izz>1.4e-5</izz></inertia></inertial><collision name=\"c\"><geometry>"
           "<box><size>0.04 0.04 0.04</size></box></geometry><surface><friction><ode><mu>" +
           mu + "</mu></ode></friction></surface></collision></link></model>";
  }
  // Kaz with motors so many times as strong as they are.
  std::unique_ptr<ReducedWorld> strong_kaz(double times) {
    auto robot = load_robot(test::kRobot);
    auto motor = load_motor_file("shared/robot/kaz/motor.xml", "");
    const auto around = load_world(test::kEmpty);
    EXPECT_TRUE(robot && motor && around);
    if (!robot || !motor || !around) return nullptr;
    motor->stall_slope_nm_per_v *= times;
    motor->winding_heat_capacity = 0;  // it would burn in a step
    for (RobotJoint& joint : robot->joints) joint.effort *= times;
    robot_ = *robot;
    return load(*around, *robot, *motor);
  }
  // From end to end of their range, every second joint the other way.
  static Drives thrown(int step) {
    Drives drives;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j)
      drives[j] = {(step / 150 + static_cast<int>(j)) % 2 == 0 ? 1.0 : -1.0, true};
    return drives;
  }

  std::optional<RobotModel> robot_;
  test::Folder folder_;
};

// Dropped from 5 m with its motors off, on a floor of full hardness: it lands, and comes to rest.
TEST_F(Degenerate, SurvivesAFallFromFiveMetres) {
  auto around = load_world(test::kEmpty);
  ASSERT_TRUE(around);
  around->robot_start.translation().z() = 5;
  const auto world = kaz_in(*around);
  ASSERT_TRUE(world);
  double fastest = 0;
  for (int i = 0; i < 4000; ++i) {
    world->step({}, 10.0);
    ArticulatedTree tree = world->tree();
    const double energy = tree.kinetic_energy() + 9.81 * tree.mass() * tree.mass_centre().z();
    ASSERT_TRUE(std::isfinite(energy)) << i;
    // Contacts take energy; their correction of depth gives back what cannot be seen here.
    ASSERT_LT(energy, 1.6 * 9.81 * 5.3) << i;
    ASSERT_LE(world->effort().residual, 1e-6) << i;
    fastest = std::max(fastest, tree.momentum().linear.norm() / tree.mass());
    if (i == 3999) {
      EXPECT_LT(tree.kinetic_energy(), 1e-4);
    }
  }
  EXPECT_GT(fastest, 9.5);
}

// Bodies put into each other are driven apart at the pace of the correction, not shot away.
TEST_F(Degenerate, DrivesApartWhatIsInsideEachOther) {
  std::string models;
  for (int i = 0; i < 10; ++i)
    models += box(number_of(i), "0.5 0 0.0" + std::to_string(10 + i), "0.5");
  const auto world = kaz_among(models);
  ASSERT_TRUE(world);
  Eigen::Vector3d before = Eigen::Vector3d(0.5, 0, 0.010);
  for (int i = 0; i < 1000; ++i) {
    world->step({}, 10.0);
    const Eigen::Vector3d now = *world->object_position("b0");
    ASSERT_TRUE(now.allFinite());
    ASSERT_LT((now - before).norm(), 3e-3) << i;  // 3 m/s
    before = now;
  }
}

// Sixty-four boxes in a heap, and the robot on the floor beside it: more than 200 points at once.
TEST_F(Degenerate, HoldsAHeapOfHundredsOfContacts) {
  std::string models;
  for (int i = 0; i < 64; ++i) {
    const double x = 0.4 + 0.041 * (i % 4), y = 0.041 * (i / 4 % 4), z = 0.02 + 0.04 * (i / 16);
    models += box(number_of(i),
                  std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z), "0.5");
  }
  const auto world = kaz_among(models);
  ASSERT_TRUE(world);
  int max = 0;
  for (int i = 0; i < 100; ++i) {
    world->step({}, 10.0);
    max = std::max(max, world->find_contacts());
  }
  EXPECT_GE(max, 200);
  EXPECT_EQ(world->diagnostics().failure, "");
  EXPECT_EQ(world->diagnostics().unconverged_steps, 0) << world->diagnostics().max_residual;
  for (int i = 0; i < 64; ++i) {
    const double z = 0.02 + 0.04 * (i / 16);
    EXPECT_NEAR((*world->object_position(number_of(i))).z(), z, 1e-3) << i;
  }
}

// Nothing brakes what slides without friction, and nothing is divided by it.
TEST_F(Degenerate, WithoutFrictionWhatSlidesGoesOn) {
  std::string model = box("b", "0.5 0 0.02", "0");
  model.insert(model.rfind("</model>"), "<kaz:kick time=\"0.1\" velocity=\"1 0.5 0\"/>");
  const auto world = kaz_among(model);
  ASSERT_TRUE(world);
  for (int i = 0; i < 100; ++i) world->step({}, 10.0);
  const Eigen::Vector3d start = *world->object_position("b");
  for (int i = 0; i < 900; ++i) world->step({}, 10.0);
  const Eigen::Vector3d gone = *world->object_position("b") - start;
  EXPECT_NEAR(gone.x(), 0.9, 1e-6);
  EXPECT_NEAR(gone.y(), 0.45, 1e-6);
  EXPECT_NEAR(gone.z(), 0, 1e-6);
  EXPECT_EQ(world->diagnostics().unconverged_steps, 0);
}

// Legs and arms of a milligram a link under a trunk of half a kilogram that falls on them: the rotors are
// what moves. Friction then increases the normal forces that increase it, and some steps do not converge:
// these are counted, and all states stay finite.
TEST_F(Degenerate, LinksNextToMasslessMove) {
  auto robot = load_robot(test::kRobot);
  const auto motor = load_motor_file("shared/robot/kaz/motor.xml", "");
  const auto around = load_world(test::kEmpty);
  ASSERT_TRUE(robot && motor && around);
  for (std::size_t i = 1; i < robot->links.size(); ++i) {
    robot->links[i].rigid.mass = 1e-6;
    robot->links[i].rigid.inertia = 1e-10 * Eigen::Matrix3d::Identity();
  }
  const auto world = load(*around, *robot, *motor);
  Drives drives;
  double furthest = 0;
  for (int i = 0; i < 2000; ++i) {
    for (std::size_t j = 0; j < KZ_JOINTS; ++j)
      drives[j] = {0.5 * std::sin(0.01 * i + static_cast<double>(j)), true};
    world->step(drives, 10.0);
    ASSERT_EQ(world->diagnostics().failure, "") << i;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      const JointState& joint = world->joints()[j];
      furthest = std::max(furthest, std::abs(joint.angle));
    }
  }
  EXPECT_GT(furthest, 0.5);
  std::printf("next to massless: %s\n", world->diagnostics().summary().c_str());
  const SolverDiagnostics& found = world->diagnostics();
  EXPECT_LT(found.unconverged_steps, 200);
  if (found.unconverged_steps > 0) {
    EXPECT_LE(found.first_s, found.last_s);
    EXPECT_LE(found.last_s, world->time_s());
    EXPECT_GT(found.drift, 0);
    EXPECT_LE(found.drift,
              static_cast<double>(found.unconverged_steps) * found.max_residual * world->step_s());
  }
}

// A person can tell from the sentence whether the run is of use.
TEST(SolverDiagnosticsText, SaysWhichStepsByHowMuchAndWhetherToTrustTheResult) {
  SolverDiagnostics none;
  EXPECT_EQ(none.summary(), "");
  SolverDiagnostics few;
  few.unconverged_steps = 3;
  few.first_s = 1.25;
  few.last_s = 2.5;
  few.max_residual = 2e-5;
  few.drift = 4e-8;
  const std::string text = few.summary();
  for (const char* part : {"3 steps", "from 1.250 s to 2.500 s", "2.0e-05 m/s", "4e-05 mm",
                           "is reliable"})
    EXPECT_NE(text.find(part), std::string::npos) << part << ": " << text;
  SolverDiagnostics many = few;
  many.drift = 0.02;
  EXPECT_NE(many.summary().find("are unreliable"), std::string::npos) << many.summary();
  EXPECT_NE(many.summary().find("--physics-step"), std::string::npos) << many.summary();
  many.drift = std::nan("");
  EXPECT_NE(many.summary().find("are unreliable"), std::string::npos) << "a velocity is no number";
}

// Five times the torque, thrown from stop to stop: the stops hold.
TEST_F(Degenerate, HugeTorquesStayWithinTheStops) {
  const auto world = strong_kaz(5);
  ASSERT_TRUE(world);
  double beyond = 0;
  for (int i = 0; i < 3000; ++i) {
    world->step(thrown(i), 10.0);
    ASSERT_EQ(world->diagnostics().failure, "") << i;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      const double angle = world->joints()[j].angle;
      beyond = std::max({beyond, angle - robot_->joints[j].upper, robot_->joints[j].lower - angle});
    }
  }
  std::printf("huge torques: %.2f mrad beyond a stop, %lld steps unsettled, worst %.1e\n",
              1e3 * beyond, static_cast<long long>(world->diagnostics().unconverged_steps),
              world->diagnostics().max_residual);
  // The stop is a spring of erp / softness / h = 2500 Nm/rad; a rotor of 5e-4 kg m2 runs into it at the
  // motor's 60 rad/s, sqrt(J / k) w = 27 mrad, and presses with 11 Nm, 4 mrad.
  EXPECT_LT(1e3 * beyond, 35);
  EXPECT_EQ(world->diagnostics().unconverged_steps, 0);
}

// Ten thousand times: joints would turn by many radians in a step. The world stops before, at numbers,
// and says so.
TEST_F(Degenerate, RotationTooFastForAStepIsReported) {
  const auto world = strong_kaz(10'000);
  ASSERT_TRUE(world);
  for (int i = 0; i < 3000 && world->diagnostics().failure.empty(); ++i)
    world->step(thrown(i), 10.0);
  EXPECT_NE(world->diagnostics().failure.find("too fast for the physics step"), std::string::npos)
      << world->diagnostics().failure;
  const double time = world->time_s();
  world->step(thrown(0), 10.0);
  EXPECT_EQ(world->time_s(), time) << "broken is broken";
  for (const JointState& joint : world->joints()) {
    EXPECT_TRUE(std::isfinite(joint.angle));
    EXPECT_TRUE(std::isfinite(joint.velocity));
  }
  EXPECT_TRUE(world->link_pose("trunk").matrix().allFinite());
}

// An error that names the joint.
TEST_F(Degenerate, SupplyThatIsNotANumberIsReported) {
  const auto around = load_world(test::kEmpty);
  ASSERT_TRUE(around);
  const auto world = kaz_in(*around);
  ASSERT_TRUE(world);
  world->step({}, 10.0);
  EXPECT_EQ(world->diagnostics().failure, "");
  Drives drives;
  for (MotorDrive& drive : drives) drive = {0.5, true};
  for (int i = 0; i < 3; ++i) world->step(drives, std::nan(""));
  EXPECT_EQ(
      world->diagnostics().failure,
      "the physics broke down at 0.001 s: the drive of joint `neck_pan` is not a number; check "
      "masses, inertias and motors of the model");
}

}  // namespace
}  // namespace kaz::sim
