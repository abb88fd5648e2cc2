// Dynamics in reduced coordinates against closed forms: what must be kept is kept, what is dropped or
// crowded comes to rest.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/reduced_world.h"

#include <cmath>
#include <limits>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/motor_file.h"

namespace kaz::sim {
namespace {

using test::Drives;

std::unique_ptr<ReducedWorld> kaz_in(const WorldModel& around, const WorldOptions& options = {}) {
  const auto robot = load_robot(test::kRobot);
  const auto motor = load_motor_file("shared/robot/kaz/motor.xml", "");
  EXPECT_TRUE(robot && motor);
  if (!robot || !motor) return nullptr;
  return std::make_unique<ReducedWorld>(around, *robot, *motor, options);
}

Drives swinging(const World& world) {
  Drives drives;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const double target = 0.4 * std::sin(6 * world.time_s() + static_cast<double>(j));
    const JointState& joint = world.joints()[j];
    drives[j] = {10 * (target - joint.angle) - 0.15 * joint.velocity, true};
  }
  return drives;
}

// Nothing outside pulls: whatever the motors do, momentum stays what it was, to rounding.
TEST(Reduced, KeepsMomentumInFlightWhateverTheMotorsDo) {
  WorldModel space;
  space.gravity.setZero();
  const auto world = kaz_in(space);
  ASSERT_TRUE(world);
  const Eigen::Vector3d start = world->tree().mass_centre();
  double energy = 0;
  for (int i = 0; i < 3000; ++i) {
    world->step(swinging(*world), 10.0);
    ArticulatedTree tree = world->tree();
    energy = std::max(energy, tree.kinetic_energy());
    ASSERT_LT(tree.momentum().angular.norm(), 1e-12);
    ASSERT_LT(tree.momentum().linear.norm(), 1e-12);
  }
  EXPECT_GT(energy, 0.02) << "it must really move";
  EXPECT_LT((world->tree().mass_centre() - start).norm(), 1e-12);
}

// An arm of 0.1 kg, horizontal at the start, with its center of mass 0.2 m from the shaft.
std::unique_ptr<ReducedWorld> servo_arm(const servo_model::IdentifiedServo& servo) {
  RobotModel robot;
  robot.fixed_base = true;
  robot.links.resize(2);
  RobotLink& arm = robot.links[1];
  arm.rigid = {"arm", 0.1, {0.2, 0, 0}, 1e-5 * Eigen::Matrix3d::Identity(), {}, {}};
  arm.parent = arm.joint = 0;
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  robot.joints.push_back({"shaft", 1, Eigen::Vector3d::UnitY(), -kEndless, kEndless});
  MotorParams motor;
  motor.max_supply_v = 12;
  use_servo(motor, servo);
  WorldModel place;
  place.gravity = {0, 0, -10};
  return std::make_unique<ReducedWorld>(place, robot, motor, WorldOptions{.hung = true});
}

servo_model::IdentifiedServo loaded_servo(double base, double external) {
  servo_model::IdentifiedServo servo;
  servo.model = 5;
  servo_model::ServoParams p;
  p.base = base;
  p.viscous = 0;
  p.external = external;
  for (const servo_model::ServoParamInfo& info : servo_model::servo_params(5))
    servo.identified.push_back({&info, p.*info.at});
  return servo;
}

// The weight is 0.2 Nm. Friction of 0.02 Nm + 0.95 times this load holds it, and + 0.85 times does not.
TEST(IdentifiedServo, HasFrictionThatDependsOnTheLoad) {
  for (const double external : {0.95, 0.85}) {
    const auto world = servo_arm(loaded_servo(0.02, external));
    // The first step has no load yet: the arm starts to move, and friction stops it within 20 ms.
    for (int i = 0; i < 1000; ++i) world->step({}, 12);
    if (external > 0.9) {
      EXPECT_LT(std::abs(world->joints()[0].angle), 3e-4);
      EXPECT_NEAR(world->joints()[0].torque, -0.2, 1e-4) << "friction holds the weight";
    } else {
      EXPECT_GT(world->joints()[0].angle, 0.1);
    }
  }
}

// Without friction the arm falls with the inertia of arm and rotor.
TEST(IdentifiedServo, HasItsRotorInertia) {
  const auto world = servo_arm(loaded_servo(0, 0));
  for (int i = 0; i < 20; ++i) world->step({}, 12);
  const double inertia = 0.1 * 0.04 + 1e-5 + servo_model::ServoParams().armature;
  EXPECT_NEAR(world->joints()[0].velocity, 0.02 * 0.2 / inertia, 1e-3);
}

TEST(IdentifiedServo, IsSavedWithItsLoad) {
  const auto world = servo_arm(loaded_servo(0.02, 0.5)), other = servo_arm(loaded_servo(0.02, 0.5));
  for (int i = 0; i < 50; ++i) world->step({}, 12);
  StateWriter writer;
  world->save(writer);
  StateReader reader(writer.bytes());
  other->restore(reader);
  ASSERT_TRUE(reader.good());
  for (int i = 0; i < 50; ++i) {
    world->step({}, 12);
    other->step({}, 12);
    ASSERT_EQ(world->joints()[0].angle, other->joints()[0].angle);
  }
}

// Falling, the centre of mass is on its parabola at each step.
TEST(Reduced, FallsByTheLaw) {
  WorldModel empty;
  const auto world = kaz_in(empty);
  ASSERT_TRUE(world);
  const double start = world->tree().mass_centre().z();
  for (int i = 1; i <= 500; ++i) {
    world->step(swinging(*world), 10.0);
    ASSERT_NEAR(world->tree().mass_centre().z(), start - 9.81 / 2 * i * i * 1e-6, 1e-12);
  }
}

// Torque-free tumbling of a body with three different moments: angular momentum to the last bit, energy
// by the midpoint rule to (w h)^2, here 1e-4, without drift.
TEST(Reduced, FreeBodyTumbles) {
  RigidLink link;
  link.mass = 0.2;
  link.inertia = Eigen::Vector3d(1e-4, 2e-4, 2.5e-4).asDiagonal();
  FreeBody body(link, Eigen::Isometry3d::Identity());
  body.advance(Eigen::Vector3d::Zero(), {0.1, 10, 0.1}, true,
               0);  // about the axis that is unstable
  const auto momentum = [&] { return Eigen::Vector3d(body.inertia() * body.angular_velocity()); };
  const Eigen::Vector3d start = momentum();
  const double energy = start.dot(body.angular_velocity());
  double flipped = 1;
  for (int i = 0; i < 10'000; ++i) {
    body.advance(Eigen::Vector3d::Zero(), body.angular_velocity(), true, 1e-3);
    ASSERT_LT((momentum() - start).norm(), 1e-9 * start.norm());
    ASSERT_NEAR(momentum().dot(body.angular_velocity()) / energy, 1, 1e-4);
    flipped = std::min(flipped, body.axes()(1, 1));
  }
  EXPECT_LT(flipped, -0.9);
}

// A pyramid would let it slip sooner along its edges than across; a cone does not care. The block slides
// at 30 degrees to every axis it could be aligned with, and its path does not bend.
TEST(Reduced, FrictionHasNoDirectionOfItsOwn) {
  VelocitySolver solver;
  for (const double angle : {0.0, 0.3, 0.8, 1.3}) {
    solver.begin(3);
    solver.matrix().add_block(0, 3, -1);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) solver.matrix().inertia_row(i)[j] = i == j ? 0.5 : 0.0;
    }
    VelocitySolver::Point point;
    point.softness = 1e-5;
    point.mu = 0.6;
    point.basis << 0, 1, 0, 0, 0, 1, 1, 0, 0;  // normal z, tangents x and y
    const VelocitySolver::Segment all{0, 3, 0};
    point.pair = solver.add_pair({&all, 1});
    double* columns = solver.columns(point.pair);
    for (int i = 0; i < 3; ++i) columns[6 * i + 3 + i] = 1;  // they are the velocity
    solver.add_point(point);
    solver.close();
    std::vector<double> v{2 * std::cos(angle), 2 * std::sin(angle), -1.0}, p(3);
    for (std::size_t i = 0; i < 3; ++i) p[i] = 0.5 * v[i];
    solver.solve(p, v, 1e-9, 60);
    EXPECT_LE(solver.residual(), 1e-9);
    // 0.5 kg stopped from 1 m/s: 0.5 N s, of which 0.6 act along the motion.
    EXPECT_NEAR(std::hypot(v[0], v[1]), 2 - 0.6, 1e-4) << angle;
    EXPECT_NEAR(std::atan2(v[1], v[0]), angle, 1e-9);
    EXPECT_NEAR(v[2], 0, 1e-4);
  }
}

}  // namespace
}  // namespace kaz::sim
