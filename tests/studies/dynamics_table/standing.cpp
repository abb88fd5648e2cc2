// Static loads: a stack of boxes, a joint on its stop, Kaz in its crouch.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/body/contact/contact_surface.h"
#include "sim/body/world/gait_testing.h"
#include "tests/studies/dynamics_table/scene.h"

namespace kaz::dynamics_table {
namespace {

using Eigen::Vector3d;

// Sum of the contact forces of `model` on other bodies, N.
Vector3d borne_by(const sim::World& world, const std::string& model) {
  Vector3d sum = Vector3d::Zero();
  for (const sim::ContactPoint& point : world.contacts()) {
    if (point.a == model) sum -= point.force;
    if (point.b == model) sum += point.force;
  }
  return sum;
}

// The uppermost box is a robot of one link, which keeps all boxes awake.
void stack(const std::string& stepper, Table& table) {
  constexpr int boxes = 5;
  constexpr double side = 0.04, mass = 0.04, softness = 0.005;
  const Vector3d size = Vector3d::Constant(side);
  sim::WorldModel around = sim::test::floor_of({.mu = 0.5}, {0, 0, -kG});
  for (int i = 0; i + 1 < boxes; ++i) {
    const auto box = sim::test::box(std::string("box").append(std::to_string(i)), mass, size,
                                    {.mu = 0.5, .softness = softness});
    around.bodies.push_back(sim::test::thing(box, {0, 0, side * (i + 0.5)}));
  }
  around.robot_start.translation().z() = side * (boxes - 1);
  const auto world = world_of(
      stepper, around,
      sim::test::lone(sim::test::box("top", mass, size, {.mu = 0.5, .softness = softness})),
      sim::test::free_motor());
  world->watch_contacts(true);
  run(*world, 2);
  const Vector3d from = world->link_pose("top").translation();
  double worst = 0;
  for (int i = 0; i < 10'000; ++i) {
    world->step({}, kVolts);
    const double borne = borne_by(*world, "floor").z() / (boxes * mass * kG) - 1;
    if (std::abs(borne) > std::abs(worst)) worst = borne;
  }
  const Vector3d top = world->link_pose("top").translation();
  // Of a seam's 4 contact points each carries a quarter of the load; its depth beyond the contact layer is
  // softness * force * step / ERP.
  double sinks = 0;
  for (int seam = 0; seam < boxes; ++seam) {
    const double soft = seam == 0 ? softness : 2 * softness;
    sinks += sim::kContactLayer + soft * (boxes - seam) * mass * kG / 4 * kStep / sim::kContactErp;
  }
  const std::string scene = "stack of five boxes of 40 mm, 40 g";
  table.put(stepper, scene, "force on the floor, worst step of 10 s",
            value("weight %.3f N", boxes * mass * kG), "", worst);
  table.put(stepper, scene, "position of the uppermost, 10 s", "at rest", "m", (top - from).norm());
  table.put(stepper, scene, "its height", value("five soft seams: -%.2f mm", sinks * 1e3), "m",
            top.z() - (side * (boxes - 0.5) - sinks));
}

// A rod with Kaz's motor, without backlash and heating, driven at full duty into its stop at 0.5 rad.
void stop(const std::string& stepper, Table& table) {
  sim::RobotModel robot = sim::test::fixed_place();
  constexpr double limit = 0.5;
  sim::test::add_link(robot, sim::test::rod("rod"), Vector3d::Zero(), Vector3d::UnitY(), -1, limit);
  sim::WorldModel space;
  space.gravity.setZero();
  const sim::MotorParams motor = sim::load_motor_file(KAZ_MOTOR, "").value().ideal();
  const auto world = world_of(stepper, space, robot, motor);
  const std::array forward{sim::MotorDrive{.duty = 1, .powered = true}};
  const double upper = limit + sim::kStopMargin;
  double deepest = 0, struck = 0, back = 0;
  for (int i = 0; i < 2000; ++i) {
    const double speed = world->joints()[0].velocity;
    world->step(forward, kVolts);
    const double beyond = world->joints()[0].angle - upper;
    if (struck == 0 && beyond > 0) struck = speed;
    deepest = std::max(deepest, beyond);
    if (struck > 0) back = std::min(back, beyond);
  }
  // At rest the torques of motor and stop are equal, up to stiction.
  const double torque = motor.stall_slope_nm_per_v * kVolts;
  const double gives = kStep * sim::kStopSoftness * torque / sim::kStopErp;
  const double holds = motor.friction_nm * motor.stiction_ratio / torque;
  const std::string scene = value("joint driven into its stop, %.1f rad/s", struck);
  char closed[96];
  std::snprintf(closed, sizeof closed, "%.3f mrad, ±%.3f by stiction", gives * 1e3,
                holds * gives * 1e3);
  table.put(stepper, scene, "penetration at rest", closed, "",
            (world->joints()[0].angle - upper) / gives - 1);
  table.put(stepper, scene, "max penetration", "no bound", "rad", deepest);
  table.put(stepper, scene, "bounce back from it", "none", "rad", back);
}

// Into the crouch of the walk within 1 s, then held.
void crouch(const std::string& stepper, Table& table) {
  const sim::RobotModel robot = sim::load_robot(KAZ_ROBOT).value();
  const sim::WorldModel around = sim::load_world(KAZ_WORLD).value();
  const auto world = world_of(stepper, around, robot, sim::load_motor_file(KAZ_MOTOR, "").value());
  world->watch_contacts(true);
  const sim::bench::Angles targets = sim::bench::walking_angles(0, 0);
  std::array<sim::MotorDrive, KZ_JOINTS> drives;
  const auto step = [&] {
    const double into = std::min(1.0, world->time_s());
    for (std::size_t i = 0; i < drives.size(); ++i) {
      const sim::JointState& joint = world->joints()[i];
      drives[i] = {20 * (into * targets[i] - joint.angle) - 0.15 * joint.velocity, true};
    }
    world->step(drives, kVolts);
  };
  while (world->time_s() < 3) step();
  const Eigen::Isometry3d from = world->link_pose("trunk");
  double borne = 0;
  Vector3d sideways = Vector3d::Zero();
  constexpr int steps = 10'000;
  for (int i = 0; i < steps; ++i) {
    step();
    const Vector3d force = borne_by(*world, "floor/slab");
    borne += force.z() / steps;
    sideways += force / steps;
  }
  sideways.z() = 0;
  const Eigen::Isometry3d to = world->link_pose("trunk");
  const double weight = robot.mass() * around.gravity.norm();
  const std::string scene = "Kaz in its crouch, held by its motors";
  table.put(stepper, scene, "force on the floor, mean of 10 s", value("weight %.3f N", weight), "",
            borne / weight - 1);
  table.put(stepper, scene, "sideways of it", "none", "N", sideways.norm());
  table.put(stepper, scene, "trunk, 10 s", "at rest", "m",
            (to.translation() - from.translation()).norm());
  table.put(stepper, scene, "trunk turns, 10 s", "not", "rad",
            Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle());
  table.put(stepper, scene, "gap in a joint", "none", "m", world->largest_joint_gap_m());
}

}  // namespace

void stand(const std::string& stepper, Table& table) {
  stack(stepper, table);
  stop(stepper, table);
  crouch(stepper, table);
}

}  // namespace kaz::dynamics_table
